#ifndef PROCESS_GUARD_CV_HPP
#define PROCESS_GUARD_CV_HPP
/* What every bridge to OpenCV does at its border, as guard_pcl.hpp does for PCL: nothing that is thrown gets out, and OpenCV
 * prints nothing. */
#include <gio/gio.h>
#include <new>
#include <opencv2/core.hpp>
#include <opencv2/core/utils/logger.hpp>

static inline int cv_guard_silence(int, const char *, const char *, const char *, int, void *)
{
	return 0;
}

/* Runs work(), which returns bool and may set error. What it throws becomes a G_IO_ERROR: "WHAT: not enough memory", of
 * OpenCV's own the first line alone. */
template <typename Work> bool cv_guard(GError **error, const char *what, Work work) noexcept
{
	try {
		cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
		cv::redirectError(cv_guard_silence);
		return work();
	} catch (const cv::Exception &e) {
		g_autofree char *reason = g_utf8_make_valid(e.err.c_str(), -1);
		g_strdelimit(g_strstrip(reason), "\n", '\0');
		if (e.code == cv::Error::StsNoMem)
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: not enough memory",
				what);
		else
			g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: %s", what, reason);
	} catch (const std::bad_alloc &) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: not enough memory", what);
	} catch (const std::exception &e) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: %s", what, e.what());
	} catch (...) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: OpenCV failed", what);
	}
	return false;
}

#endif
