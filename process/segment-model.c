#include "process/segment-model.h"
#include "firmware-io/files.h"
#include "firmware-io/sha256.h"
#include "process/semantic-model.h"
#include <string.h>

struct segment_model {
	semantic_model *net;
	double confidence;
};

segment_model *segment_model_open(const char *path, double confidence, GError **error)
{
	g_autoptr(segment_model) m = g_new0(segment_model, 1);
	m->confidence = confidence;
	m->net = semantic_model_open(path, error);
	return m->net ? g_steal_pointer(&m) : NULL;
}

void segment_model_free(segment_model *m)
{
	if (!m)
		return;
	semantic_model_free(m->net);
	g_free(m);
}

static char *manifest_path_of(const char *path)
{
	g_autofree char *stem = g_strdup(path);
	if (g_str_has_suffix(stem, ".onnx"))
		stem[strlen(stem) - strlen(".onnx")] = 0;
	return g_strconcat(stem, ".json", NULL);
}

char *segment_model_fingerprint(const char *path, GError **error)
{
	g_autofree char *beside = manifest_path_of(path), *net = NULL, *told = NULL;
	gsize net_bytes, told_bytes;
	if (!g_file_get_contents(path, &net, &net_bytes, error) ||
		!g_file_get_contents(beside, &told, &told_bytes, error))
		return NULL;
	g_autofree char *a = sha256_of(net, net_bytes), *b = sha256_of(told, told_bytes);
	return g_strconcat(a, " ", b, NULL);
}

/* In the scanner's frame, as the product has them. */
static geometry *unpack_normals(const struct scan_points *p)
{
	const range_grid *g = p->data->grid;
	size_t cells = range_grid_cells(g);
	geometry *n = g_new0(geometry, 1);
	*n = (geometry){ .columns = g->columns, .rows = g->rows };
	n->normal_x = g_new(float, cells);
	n->normal_y = g_new(float, cells);
	n->normal_z = g_new(float, cells);
	n->plane_error_m = g_memdup2(p->geometry->plane_error_m, cells * sizeof(float));
	n->curvature = g_memdup2(p->geometry->curvature, cells * sizeof(float));
	for (size_t i = 0; i < cells; i++) {
		float normal[3];
		model_unpack_normal(p->geometry->normal[i], normal);
		n->normal_x[i] = normal[0];
		n->normal_y[i] = normal[1];
		n->normal_z[i] = normal[2];
	}
	return n;
}

static void free_normals(geometry *n)
{
	if (!n)
		return;
	g_free(n->normal_x);
	g_free(n->normal_y);
	g_free(n->normal_z);
	g_free(n->plane_error_m);
	g_free(n->curvature);
	g_free(n);
}

static bool has_all(const semantic_manifest *wanted, const struct scan_points *p)
{
	const range_grid *g = p->data->grid;
	for (uint32_t i = 0; i < wanted->inputs; i++) {
		enum semantic_channel c = wanted->input[i].channel;
		bool is_colour = c == SEMANTIC_RED || c == SEMANTIC_GREEN || c == SEMANTIC_BLUE;
		bool is_normal = c >= SEMANTIC_NORMAL_X && c <= SEMANTIC_CURVATURE;
		if ((is_colour && !g->rgb) || (c == SEMANTIC_INTENSITY && !g->intensity) ||
			(is_normal && !p->geometry))
			return false;
	}
	return true;
}

bool segment_model_label(gpointer user_data, const struct segmentation_scan *scan,
	const float *height_m, uint8_t *ret_label, GError **error)
{
	struct segment_model *m = user_data;
	const range_grid *g = scan->points.data->grid;
	const semantic_manifest *told = semantic_model_manifest(m->net);
	memset(ret_label, LABEL_NONE, scan->points.count);
	if (!g || !has_all(told, &scan->points))
		return true;
	geometry *normals = scan->points.geometry ? unpack_normals(&scan->points) : NULL;
	g_autofree float *confidence = g_new(float, scan->points.count + 1);
	g_autofree uint8_t *class = g_malloc(scan->points.count + 1);
	struct semantic_scan input = { g, normals, height_m };
	bool good = semantic_model_run(m->net, &input, class, confidence, error);
	for (uint64_t i = 0; good && i < scan->points.count; i++)
		if (class[i] != SEMANTIC_NONE && confidence[i] >= m->confidence)
			ret_label[i] = (uint8_t)told->kind[class[i]];
	free_normals(normals);
	return good;
}
