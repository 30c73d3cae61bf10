#include "process/guard_cv.hpp"
#include "process/semantic-net.h"
#include <cstring>
#include <opencv2/dnn.hpp>
#include <string>

struct semantic_net {
	cv::dnn::Net net;
};

/* "Conv" of what OpenCV says when it does not know one: ... layer "onnx_node!t1" of type "Conv" ... */
static bool unknown_layer(const cv::Exception &e, const char *what, GError **error)
{
	const std::string mark = "of type \"";
	size_t from = e.err.find(mark);
	if (e.err.find("Can't create layer") == std::string::npos || from == std::string::npos)
		return false;
	from += mark.size();
	size_t to = from;
	while (to < e.err.size() && e.err[to] != '"' && g_ascii_isprint(e.err[to]))
		to++;
	std::string name = e.err.substr(from, to - from);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_SUPPORTED,
		"%s: it has a layer of the kind \"%s\", which OpenCV cannot run", what,
		name.c_str());
	return true;
}

static cv::dnn::Net read_net(const uint8_t *bytes, size_t length)
{
	return cv::dnn::readNetFromONNX(reinterpret_cast<const char *>(bytes), length);
}

semantic_net *semantic_net_new(
	const uint8_t *bytes, size_t length, const char *what, GError **error)
{
	semantic_net *n = nullptr;
	g_autofree char *cannot = g_strdup_printf("%s: OpenCV cannot run this network", what);
	cv_guard(error, cannot, [&] {
		cv::dnn::Net net;
		try {
			net = read_net(bytes, length);
		} catch (const cv::Exception &e) {
			if (unknown_layer(e, what, error))
				return false;
			throw;
		}
		if (net.empty()) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
				"%s: there is no layer in this network", what);
			return false;
		}
		net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
		net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
		n = new semantic_net{ net };
		return true;
	});
	return n;
}

void semantic_net_free(semantic_net *n)
{
	delete n;
}

static std::string shape_of(const cv::Mat &m)
{
	std::string shape;
	for (int i = 0; i < m.dims; i++)
		shape += (i ? " x " : "") + std::to_string(m.size[i]);
	return shape;
}

bool semantic_net_run(semantic_net *n, const float *in, uint32_t channels, uint32_t columns,
	uint32_t rows, uint32_t classes, float *ret_scores, const char *what, GError **error)
{
	g_autofree char *cannot = g_strdup_printf(
		"%s: cannot be run on %u channels of %u x %u cells", what, channels, columns, rows);
	return cv_guard(error, cannot, [&] {
		int size[4] = { 1, (int)channels, (int)rows, (int)columns };
		n->net.setInput(cv::Mat(4, size, CV_32F, const_cast<float *>(in)));
		cv::Mat out = n->net.forward();
		if (out.dims != 4 || out.size[0] != 1 || out.size[1] != (int)classes ||
			out.size[2] != (int)rows || out.size[3] != (int)columns ||
			out.type() != CV_32F || !out.isContinuous()) {
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
				"%s: its answer is %s numbers, where 1 x %u x %u x %u are needed "
				"(classes, rows, columns)",
				what, shape_of(out).c_str(), classes, rows, columns);
			return false;
		}
		std::memcpy(ret_scores, out.ptr<float>(), out.total() * sizeof *ret_scores);
		return true;
	});
}
