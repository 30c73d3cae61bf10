#include "process/semantic-model.h"
#include "process/onnx-check.h"
#include "process/semantic-net.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

struct semantic_model {
	char *path;
	semantic_manifest *manifest;
	semantic_net *net;
};

/* ---- opening ---- */

static char *manifest_path_of(const char *path)
{
	const char *dot = strrchr(path, '.'), *slash = strrchr(path, '/');
	if (!dot || (slash && dot < slash))
		dot = path + strlen(path);
	return g_strdup_printf("%.*s.json", (int)(dot - path), path);
}

static bool read_file(const char *path, char **ret, gsize *ret_length, GError **error)
{
	g_autoptr(GError) why = NULL;
	if (g_file_get_contents(path, ret, ret_length, &why))
		return true;
	bool missing = g_error_matches(why, G_FILE_ERROR, G_FILE_ERROR_NOENT);
	g_set_error(error, G_IO_ERROR, missing ? G_IO_ERROR_NOT_FOUND : G_IO_ERROR_FAILED,
		missing ? "%s: there is no such file" : "%s: cannot be read", path);
	return false;
}

static bool open_manifest(semantic_model *m, GError **error)
{
	g_autofree char *path = manifest_path_of(m->path), *text = NULL;
	gsize length;
	if (!read_file(path, &text, &length, error))
		return false;
	m->manifest = semantic_manifest_parse(text, length, path, error);
	return m->manifest;
}

static bool open_net(semantic_model *m, GError **error)
{
	g_autofree char *bytes = NULL;
	gsize length;
	if (!read_file(m->path, &bytes, &length, error))
		return false;
	if (!onnx_check((const uint8_t *)bytes, length)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
			"%s: this is no ONNX model, or it is cut off", m->path);
		return false;
	}
	m->net = semantic_net_new((const uint8_t *)bytes, length, m->path, error);
	return m->net;
}

semantic_model *semantic_model_open(const char *path, GError **error)
{
	g_autoptr(semantic_model) m = g_new0(semantic_model, 1);
	m->path = g_strdup(path);
	if (!open_manifest(m, error) || !open_net(m, error))
		return NULL;
	return g_steal_pointer(&m);
}

void semantic_model_free(semantic_model *m)
{
	if (!m)
		return;
	semantic_manifest_free(m->manifest);
	semantic_net_free(m->net);
	g_free(m->path);
	g_free(m);
}

const semantic_manifest *semantic_model_manifest(const semantic_model *m)
{
	return m->manifest;
}

/* ---- channels ---- */

static bool is_known(const struct semantic_scan *scan, enum semantic_channel channel)
{
	switch (channel) {
	case SEMANTIC_INTENSITY: return scan->grid->intensity;
	case SEMANTIC_RED:
	case SEMANTIC_GREEN:
	case SEMANTIC_BLUE: return scan->grid->rgb;
	case SEMANTIC_HEIGHT: return scan->height_m;
	case SEMANTIC_NORMAL_X:
	case SEMANTIC_NORMAL_Y:
	case SEMANTIC_NORMAL_Z:
	case SEMANTIC_CURVATURE: return scan->normals;
	default: return true;
	}
}

static float value_of(const struct semantic_scan *scan, enum semantic_channel channel, size_t i)
{
	switch (channel) {
	case SEMANTIC_RANGE: return scan->grid->range_m[i];
	case SEMANTIC_INTENSITY: return scan->grid->intensity[i] / 65535.0f;
	case SEMANTIC_RED: return scan->grid->rgb[3 * i] / 255.0f;
	case SEMANTIC_GREEN: return scan->grid->rgb[3 * i + 1] / 255.0f;
	case SEMANTIC_BLUE: return scan->grid->rgb[3 * i + 2] / 255.0f;
	case SEMANTIC_HEIGHT: return scan->height_m[i];
	case SEMANTIC_NORMAL_X: return scan->normals->normal_x[i];
	case SEMANTIC_NORMAL_Y: return scan->normals->normal_y[i];
	case SEMANTIC_NORMAL_Z: return scan->normals->normal_z[i];
	case SEMANTIC_CURVATURE: return scan->normals->curvature[i];
	default: return 1;
	}
}

/* What no number says is 0 before it is scaled; where there is no point, everything is 0. */
static float channel_at(
	const struct semantic_scan *scan, const struct semantic_input *input, size_t i)
{
	if (!(scan->grid->range_m[i] > 0))
		return 0;
	float value = value_of(scan, input->channel, i);
	return ((isfinite(value) ? value : 0) - input->mean) * input->scale;
}

static bool check_channels(
	const semantic_model *m, const struct semantic_scan *scan, GError **error)
{
	for (uint32_t k = 0; k < m->manifest->inputs; k++) {
		enum semantic_channel channel = m->manifest->input[k].channel;
		if (is_known(scan, channel))
			continue;
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_SUPPORTED,
			"%s: it needs the channel \"%s\", which this scan does not have", m->path,
			semantic_channel_names[channel]);
		return false;
	}
	return true;
}

/* ---- tiles ---- */

/* Along one axis: a tile looks at size cells from first, and decides on those from core to core_end. */
struct span {
	int64_t first;
	uint32_t size, core, core_end;
};

/* The span whose core begins at core. */
static struct span span_at(
	uint32_t cells, bool wraps, uint32_t tile, uint32_t overlap, uint32_t core)
{
	uint32_t inner = tile - 2 * overlap;
	if (wraps)
		return (struct span){ (int64_t)core - overlap, tile, core,
			MIN(core + inner, cells) };
	if (tile >= cells)
		return (struct span){ 0, tile, 0, cells };
	int64_t first = core ? (int64_t)core - overlap : 0;
	if (first + tile >= cells)
		return (struct span){ (int64_t)cells - tile, tile, core, cells };
	return (struct span){ first, tile, core, (uint32_t)(first + tile - overlap) };
}

struct job {
	semantic_model *model;
	const struct semantic_scan *scan;
	uint32_t tile_columns, tile_rows;
	float *in, *scores; /* of a tile */
	uint8_t *class;
	float *confidence;
};

static void fill_plane(const struct job *j, const struct semantic_input *input,
	const struct span *across, const struct span *down, float *plane)
{
	const range_grid *g = j->scan->grid;
	for (uint32_t r = 0; r < down->size; r++)
		for (uint32_t c = 0; c < across->size; c++) {
			int64_t row = down->first + r, column = across->first + c;
			if (g->wraps)
				column = ((column % g->columns) + g->columns) % g->columns;
			bool inside = row < g->rows && column < g->columns;
			plane[(size_t)r * across->size + c] =
				inside ? channel_at(j->scan, input,
						 (size_t)(row * g->columns + column))
				       : 0;
		}
}

/* The likeliest of the scores of a cell, which are stride apart. */
static uint8_t likeliest(const float *score, size_t stride, const semantic_manifest *m, float *ret)
{
	uint32_t best = 0;
	for (uint32_t k = 1; k < m->classes; k++)
		if (score[k * stride] > score[best * stride])
			best = k;
	float sum = 0;
	for (uint32_t k = 0; k < m->classes && !m->probabilities; k++)
		sum += expf(score[k * stride] - score[best * stride]);
	float confidence = m->probabilities ? score[best * stride] : 1 / sum;
	*ret = confidence > 0 ? fminf(confidence, 1) : 0; /* what is no number is no confidence */
	return (uint8_t)best;
}

static void keep_core(const struct job *j, const struct span *across, const struct span *down)
{
	const range_grid *g = j->scan->grid;
	size_t stride = (size_t)across->size * down->size;
	for (uint32_t row = down->core; row < down->core_end; row++)
		for (uint32_t column = across->core; column < across->core_end; column++) {
			size_t i = (size_t)row * g->columns + column,
			       at = (size_t)(row - down->first) * across->size +
				    (size_t)(column - across->first);
			if (g->range_m[i] > 0)
				j->class[i] = likeliest(j->scores + at, stride, j->model->manifest,
					&j->confidence[i]);
		}
}

static bool run_tile(
	const struct job *j, const struct span *across, const struct span *down, GError **error)
{
	const semantic_manifest *m = j->model->manifest;
	size_t cells = (size_t)across->size * down->size;
	for (uint32_t k = 0; k < m->inputs; k++)
		fill_plane(j, &m->input[k], across, down, j->in + k * cells);
	if (!semantic_net_run(j->model->net, j->in, m->inputs, across->size, down->size, m->classes,
		    j->scores, j->model->path, error))
		return false;
	keep_core(j, across, down);
	return true;
}

static bool run_tiles(const struct job *j, GError **error)
{
	const range_grid *g = j->scan->grid;
	uint32_t overlap = j->model->manifest->overlap,
		 over = j->model->manifest->tile_rows ? overlap : 0;
	for (uint32_t row = 0; row < g->rows;) {
		struct span down = span_at(g->rows, false, j->tile_rows, over, row);
		for (uint32_t column = 0; column < g->columns;) {
			struct span across =
				span_at(g->columns, g->wraps, j->tile_columns, overlap, column);
			if (!run_tile(j, &across, &down, error))
				return false;
			column = across.core_end;
		}
		row = down.core_end;
	}
	return true;
}

bool semantic_model_run(semantic_model *m, const struct semantic_scan *scan, uint8_t *ret_class,
	float *ret_confidence, GError **error)
{
	const semantic_manifest *f = m->manifest;
	const range_grid *g = scan->grid;
	size_t n = range_grid_cells(g);
	if (!check_channels(m, scan, error))
		return false;
	uint32_t columns = f->tile_columns ? f->tile_columns
			   : g->wraps      ? g->columns + 2 * f->overlap
					   : g->columns,
		 rows = f->tile_rows ? f->tile_rows : g->rows;
	size_t cells = (size_t)columns * rows;
	g_autofree float *in = g_new(float, cells * f->inputs),
			 *scores = g_new(float, cells * f->classes), *confidence = g_new0(float, n);
	g_autofree uint8_t *class = g_malloc(n);
	memset(class, SEMANTIC_NONE, n);
	struct job j = { m, scan, columns, rows, in, scores, class, confidence };
	if (!run_tiles(&j, error))
		return false;
	memcpy(ret_class, class, n);
	memcpy(ret_confidence, confidence, n * sizeof *confidence);
	return true;
}
