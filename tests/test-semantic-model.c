/* Models made by hand, on a panorama made by hand: what they answer is known for every cell. */
#include "acquire/manifest.h"
#include "process/semantic-model.h"
#include "tests/onnx-made.h"
#include "tests/simulated.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

enum { COLUMNS = 90, ROWS = 24, CELLS = COLUMNS * ROWS };

/* ---- a scan and models ---- */

struct made {
	range_grid *grid;
	float height_m[CELLS];
};

static struct made *made_new(void)
{
	struct made *m = g_new0(struct made, 1);
	struct panorama_desc desc = panorama_desc_for(COLUMNS, ROWS);
	g_autoptr(panorama) p = panorama_new(&desc, NULL);
	g_autoptr(GRand) chance = g_rand_new_with_seed(5);
	for (int i = 0; i < CELLS; i++) {
		double azimuth = (i % COLUMNS + 0.5) * p->column_rad;
		float up = (float)(desc.elevation_max_rad - (i / COLUMNS + 0.5) * p->row_rad),
		      range = g_rand_double(chance) < 0.1
				      ? 0
				      : (float)g_rand_double_range(chance, 2, 40);
		uint16_t intensity = (uint16_t)g_rand_int_range(chance, 0, 65536);
		panorama_add(p, &azimuth, &up, &range, &intensity, 1);
		m->height_m[i] = (float)g_rand_int_range(chance, -1, 30) * 0.1f + 0.05f;
	}
	m->grid = range_grid_from_panorama(p);
	return m;
}

static void made_free(struct made *m)
{
	range_grid_free(m->grid);
	g_free(m);
}
typedef struct made made;
G_DEFINE_AUTOPTR_CLEANUP_FUNC(made, made_free)

static char *write_model(GByteArray *onnx, const char *json)
{
	g_autofree char *folder = simulated_folder();
	char *path = g_build_filename(folder, "made.onnx", NULL);
	g_autofree char *beside = g_build_filename(folder, "made.json", NULL);
	g_autoptr(GError) error = NULL;
	g_file_set_contents(path, (const char *)onnx->data, onnx->len, &error);
	g_assert_no_error(error);
	g_file_set_contents(beside, json, -1, &error);
	g_assert_no_error(error);
	return path;
}

/* Terrain where it is low, building where it is high or near, far away else. */
static GByteArray *by_height(uint64_t channels, uint64_t classes, uint64_t stride)
{
	static const float weight[] = { -10, 0, 5, -0.5f, 0, 0 }, bias[] = { 2, 10, 0 };
	GByteArray *graph = g_byte_array_new();
	put_convolution(graph, 0, 1, channels, classes, 1, stride, weight, bias);
	return model_of(graph, channels, classes, 1, 0, 0);
}

#define BY_HEIGHT_CHANNELS "\"channels\": [\"height_m\", \"range_m\"]"
#define BY_HEIGHT_CLASSES  "\"classes\": [\"terrain\", \"building\", \"far away\"]"
#define BY_HEIGHT          "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES "}"

/* ---- what it answers ---- */

static void test_classes(void)
{
	g_autoptr(made) m = made_new();
	g_autoptr(GByteArray) onnx = by_height(2, 3, 1);
	g_autofree char *path = write_model(onnx, BY_HEIGHT);
	g_autoptr(GError) error = NULL;
	g_autoptr(semantic_model) model = semantic_model_open(path, &error);
	g_assert_no_error(error);
	const semantic_manifest *f = semantic_model_manifest(model);
	g_assert_cmpuint(f->kind[0], ==, CLASS_TERRAIN);
	g_assert_cmpuint(f->kind[1], ==, CLASS_BUILDING);
	g_assert_cmpuint(f->kind[2], ==, CLASS_OTHER);
	g_assert_cmpstr(f->class_name[2], ==, "far away");
	uint8_t class[CELLS];
	float confidence[CELLS];
	struct semantic_scan scan = { .grid = m->grid, .height_m = m->height_m };
	g_assert_true(semantic_model_run(model, &scan, class, confidence, &error));
	g_assert_no_error(error);
	size_t of[3] = { 0 };
	for (int i = 0; i < CELLS; i++) {
		if (!(m->grid->range_m[i] > 0)) {
			g_assert_cmpuint(class[i], ==, SEMANTIC_NONE);
			g_assert_cmpfloat(confidence[i], ==, 0);
			continue;
		}
		double h = m->height_m[i], r = m->grid->range_m[i],
		       score[3] = { 2 - 10 * h, 10 + 5 * h - 0.5 * r, 0 }, sum = 0;
		int best = score[1] > score[0] ? 1 : 0;
		best = score[2] > score[best] ? 2 : best;
		for (int k = 0; k < 3; k++)
			sum += exp(score[k] - score[best]);
		g_assert_cmpuint(class[i], ==, (unsigned)best);
		g_assert_cmpfloat_with_epsilon(confidence[i], 1 / sum, 1e-4);
		of[best]++;
	}
	for (int k = 0; k < 3; k++)
		g_assert_cmpuint(of[k], >, 20);
}

/* Every channel comes where it should and as it should: a model of one channel whose scores are the channel and a constant. */
static void test_channels(void)
{
	g_autoptr(made) m = made_new();
	g_autoptr(geometry) normals = geometry_estimate(m->grid, NULL);
	m->grid->rgb = g_aligned_alloc0(CELLS, 3, 64);
	for (int i = 0; i < 3 * CELLS; i++)
		m->grid->rgb[i] = (uint8_t)(i * 37);
	const float *known[SEMANTIC_CHANNELS] = { [SEMANTIC_RANGE] = m->grid->range_m,
		[SEMANTIC_HEIGHT] = m->height_m,
		[SEMANTIC_NORMAL_X] = normals->normal_x,
		[SEMANTIC_NORMAL_Y] = normals->normal_y,
		[SEMANTIC_NORMAL_Z] = normals->normal_z,
		[SEMANTIC_CURVATURE] = normals->curvature };
	struct semantic_scan scan = { m->grid, normals, m->height_m };
	for (int k = 0; k < SEMANTIC_CHANNELS; k++) {
		static const float weight[] = { 1, 0 }, bias[] = { 0, 0 };
		GByteArray *graph = g_byte_array_new();
		put_convolution(graph, 0, 1, 1, 2, 1, 1, weight, bias);
		g_autoptr(GByteArray) onnx = model_of(graph, 1, 2, 1, ROWS, COLUMNS);
		g_autofree char *json = g_strdup_printf("{\"channels\": [{\"name\": \"%s\", "
							"\"mean\": 0.25, \"scale\": 2}], "
							"\"classes\": [\"water\", \"other\"]}",
					semantic_channel_names[k]),
				*path = write_model(onnx, json);
		g_autoptr(GError) error = NULL;
		g_autoptr(semantic_model) model = semantic_model_open(path, &error);
		g_assert_no_error(error);
		uint8_t class[CELLS];
		float confidence[CELLS];
		g_assert_true(semantic_model_run(model, &scan, class, confidence, &error));
		for (int i = 0; i < CELLS; i++) {
			if (!(m->grid->range_m[i] > 0))
				continue;
			int colour = k - SEMANTIC_RED;
			double value = known[k]                 ? known[k][i]
				       : k == SEMANTIC_MEASURED ? 1
				       : k == SEMANTIC_INTENSITY
					       ? m->grid->intensity[i] / 65535.0
					       : m->grid->rgb[3 * i + colour] / 255.0;
			double score = ((isnan(value) ? 0 : value) - 0.25) * 2,
			       likely = 1 / (1 + exp(-fabs(score)));
			if (fabs(score) > 1e-5)
				g_assert_cmpuint(class[i], ==, score > 0 ? 0 : 1);
			g_assert_cmpfloat_with_epsilon(confidence[i], likely, 1e-4);
		}
	}
}

/* A model that looks around: 3 x 3, then a bend, then the classes. */
static GByteArray *looking_around(
	float weight[4 * 9], float mix[3 * 4], uint64_t rows, uint64_t columns)
{
	static const float none[4] = { 0 };
	g_autoptr(GRand) chance = g_rand_new_with_seed(9);
	for (int i = 0; i < 4 * 9; i++)
		weight[i] = (float)g_rand_double_range(chance, -1, 1);
	for (int i = 0; i < 3 * 4; i++)
		mix[i] = (float)g_rand_double_range(chance, -1, 1);
	GByteArray *graph = g_byte_array_new();
	put_convolution(graph, 0, 1, 1, 4, 3, 1, weight, none);
	put_part(graph, 1, node_begin("Relu", 1, 2));
	put_convolution(graph, 2, 3, 4, 3, 1, 1, mix, none);
	return model_of(graph, 1, 3, 3, rows, columns);
}

/* The same by hand: rows end, columns go round. */
static int expected(const struct made *m, int i, const float *weight, const float *mix, double *ret)
{
	double score[3] = { 0 }, sum = 0;
	for (int k = 0; k < 4; k++) {
		double v = 0;
		for (int dy = -1; dy <= 1; dy++)
			for (int dx = -1; dx <= 1; dx++) {
				int row = i / COLUMNS + dy,
				    column = (i % COLUMNS + dx + COLUMNS) % COLUMNS;
				if (row >= 0 && row < ROWS)
					v += weight[k * 9 + (dy + 1) * 3 + dx + 1] * 0.1 *
					     m->grid->range_m[row * COLUMNS + column];
			}
		for (int c = 0; c < 3; c++)
			score[c] += mix[c * 4 + k] * fmax(v, 0);
	}
	int best = 0;
	for (int c = 1; c < 3; c++)
		best = score[c] > score[best] ? c : best;
	for (int c = 0; c < 3; c++)
		sum += exp(score[c] - score[best]);
	*ret = 1 / sum;
	return best;
}

static void assert_looks_around(const char *tiling, uint64_t rows, uint64_t columns)
{
	g_autoptr(made) m = made_new();
	float weight[4 * 9], mix[3 * 4], confidence[CELLS];
	uint8_t class[CELLS];
	g_autoptr(GByteArray) onnx = looking_around(weight, mix, rows, columns);
	g_autofree char *json = g_strdup_printf(
				"{\"channels\": [{\"name\": \"range_m\", \"scale\": 0.1}],"
				"\"classes\": [\"a\", \"b\", \"water\"], %s}",
				tiling),
			*path = write_model(onnx, json);
	g_autoptr(GError) error = NULL;
	g_autoptr(semantic_model) model = semantic_model_open(path, &error);
	g_assert_no_error(error);
	struct semantic_scan scan = { .grid = m->grid };
	semantic_model_run(model, &scan, class, confidence, &error);
	g_assert_no_error(error);
	size_t close = 0;
	for (int i = 0; i < CELLS; i++) {
		double likely;
		int best = expected(m, i, weight, mix, &likely);
		if (!(m->grid->range_m[i] > 0))
			continue;
		g_assert_cmpfloat_with_epsilon(confidence[i], likely, 1e-4);
		if (fabs(likely - 0.5) < 1e-3 || likely < 0.35)
			close++; /* two classes are as likely: rounding decides */
		else
			g_assert_cmpuint(class[i], ==, (unsigned)best);
	}
	g_assert_cmpuint(close, <, CELLS / 20);
}

static void test_tiles(void)
{
	assert_looks_around("\"overlap\": 1", ROWS, COLUMNS + 2);
	assert_looks_around("\"overlap\": 7", 0, 0);
	assert_looks_around("\"tile\": [16, 8], \"overlap\": 1", 8, 16);
	assert_looks_around("\"tile\": [17, 11], \"overlap\": 3", 11, 17);
	assert_looks_around("\"tile\": [23, 24], \"overlap\": 2", ROWS, 23);
	assert_looks_around(
		"\"tile\": [200, 40], \"overlap\": 4", 40, 200); /* more than there is */
}

/* ---- what is wrong ---- */

static void assert_refused(GByteArray *onnx, const char *json, const char *why)
{
	g_autoptr(made) m = made_new();
	g_autofree char *path = write_model(onnx, json);
	g_autoptr(GError) error = NULL;
	g_autoptr(semantic_model) model = semantic_model_open(path, &error);
	uint8_t class[CELLS];
	float confidence[CELLS];
	struct semantic_scan scan = { .grid = m->grid, .height_m = m->height_m };
	if (model)
		g_assert_false(semantic_model_run(model, &scan, class, confidence, &error));
	g_assert_nonnull(error);
	g_test_message("%s", strstr(error->message, "made."));
	g_assert_nonnull(strstr(error->message, "made."));
	g_assert_nonnull(strstr(error->message, why));
	g_assert_null(strchr(error->message, '\n'));
}

static void test_json(void)
{
	static const struct {
		const char *json, *why;
	} wrong[] = {
		{ "", "made.json" },
		{ "[1]", "made.json" },
		{ "{" BY_HEIGHT_CLASSES "}", "'channels' is missing" },
		{ "{" BY_HEIGHT_CHANNELS "}", "'classes' is missing" },
		{ "{\"channels\": [], " BY_HEIGHT_CLASSES "}", "'channels' must be a list" },
		{ "{\"channels\": [\"heigth_m\"], " BY_HEIGHT_CLASSES "}",
			"no channel \"heigth_m\"" },
		{ "{\"channels\": [7], " BY_HEIGHT_CLASSES "}", "must be a name" },
		{ "{\"channels\": [\"range_m\", \"range_m\"], " BY_HEIGHT_CLASSES "}",
			"\"range_m\" is there twice" },
		{ "{\"channels\": [{\"name\": \"range_m\", \"mean\": \"0\"}], " BY_HEIGHT_CLASSES
		  "}",
			"'mean' must be a number" },
		{ "{\"channels\": [{\"name\": \"range_m\", \"scale\": null}], " BY_HEIGHT_CLASSES
		  "}",
			"'scale' must be a number" },
		{ "{" BY_HEIGHT_CHANNELS ", \"classes\": [\"water\", \"\"]}",
			"entry 2: must be a name" },
		{ "{" BY_HEIGHT_CHANNELS ", \"classes\": [\"water\", \"water\"]}",
			"\"water\" is there twice" },
		{ "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES ", \"tile\": 16}",
			"'tile' must be columns" },
		{ "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES ", \"tile\": [16]}", "'tile'" },
		{ "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES ", \"tile\": [16, 0]}", "'tile'" },
		{ "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES
		  ", \"tile\": [16, 16], \"overlap\": 8}",
			"'overlap' must be less" },
		{ "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES ", \"overlap\": -1}", "overlap" },
		{ "{" BY_HEIGHT_CHANNELS ", " BY_HEIGHT_CLASSES ", \"scores\": \"odds\"}",
			"'scores'" },
		{ "{\"channels\": [\"height_m\", \"red\"], " BY_HEIGHT_CLASSES "}",
			"needs the channel \"red\"" },
		{ "{\"channels\": [\"height_m\"], " BY_HEIGHT_CLASSES "}",
			"made.onnx: cannot be run on 1 channels" },
		{ "{" BY_HEIGHT_CHANNELS ", \"classes\": [\"water\"]}",
			"where 1 x 1 x 24 x 90 are needed" },
	};
	g_autoptr(GByteArray) onnx = by_height(2, 3, 1);
	for (size_t i = 0; i < G_N_ELEMENTS(wrong); i++)
		assert_refused(onnx, wrong[i].json, wrong[i].why);
}

static void test_missing(void)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "made.onnx", NULL),
			*beside = g_build_filename(folder, "made.json", NULL);
	g_assert_null(semantic_model_open(path, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_nonnull(strstr(error->message, "made.json: there is no such file"));
	g_clear_error(&error);
	g_assert_true(g_file_set_contents(beside, BY_HEIGHT, -1, NULL));
	g_assert_null(semantic_model_open(path, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND);
	g_assert_nonnull(strstr(error->message, "made.onnx: there is no such file"));
}

static void test_networks(void)
{
	g_autoptr(GByteArray) text = g_byte_array_new(), strided = by_height(2, 3, 2);
	g_byte_array_append(text, (const uint8_t *)"this is a note, and no model", 28);
	assert_refused(text, BY_HEIGHT, "no ONNX model");
	g_byte_array_set_size(text, 0);
	assert_refused(text, BY_HEIGHT, "no ONNX model");
	assert_refused(strided, BY_HEIGHT, "1 x 3 x 12 x 45 numbers");
	GByteArray *graph = g_byte_array_new();
	put_part(graph, 1, node_begin("Clairvoyance", 0, 1));
	g_autoptr(GByteArray) unknown = model_of(graph, 2, 3, 1, ROWS, COLUMNS);
	assert_refused(unknown, BY_HEIGHT, "a layer of the kind \"Clairvoyance\"");
	g_autoptr(GByteArray) nothing = model_of(g_byte_array_new(), 2, 3, 0, ROWS, COLUMNS);
	assert_refused(nothing, BY_HEIGHT, "made.onnx");
}

static void test_cut(void)
{
	g_autoptr(GByteArray) whole = by_height(2, 3, 1);
	for (guint length = 0; length < whole->len; length += 3) {
		g_autoptr(GByteArray) cut = g_byte_array_new();
		g_byte_array_append(cut, whole->data, length);
		g_autofree char *path = write_model(cut, BY_HEIGHT);
		g_autoptr(GError) error = NULL;
		g_assert_null(semantic_model_open(path, &error));
		g_assert_nonnull(strstr(error->message, "no ONNX model, or it is cut off"));
	}
}

/* With a few bytes changed, a model is refused in one line or answers something. */
static void test_damaged(void)
{
	g_autoptr(made) m = made_new();
	struct semantic_scan scan = { .grid = m->grid, .height_m = m->height_m };
	g_autoptr(GRand) chance = g_rand_new_with_seed(11);
	g_autoptr(GByteArray) whole = by_height(2, 3, 1);
	size_t refused = 0, answered = 0;
	for (int round = 0; round < 500; round++) {
		g_autoptr(GByteArray) damaged = g_byte_array_new();
		g_byte_array_append(damaged, whole->data, whole->len);
		for (int k = 0; k <= round % 3; k++)
			damaged->data[g_rand_int_range(chance, 0, (gint32)whole->len)] =
				(uint8_t)g_rand_int(chance);
		g_autofree char *path = write_model(damaged, BY_HEIGHT);
		g_autoptr(GError) error = NULL;
		g_autoptr(semantic_model) model = semantic_model_open(path, &error);
		uint8_t class[CELLS];
		float confidence[CELLS];
		bool good = model && semantic_model_run(model, &scan, class, confidence, &error);
		g_assert_true(good == !error);
		g_assert_true(good || !strchr(error->message, '\n'));
		refused += !good;
		answered += good;
	}
	g_test_message("%zu refused, %zu answered", refused, answered);
	g_assert_cmpuint(refused, >, 250);
	g_assert_cmpuint(answered, >, 20);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/semantic-model/classes", test_classes);
	g_test_add_func("/semantic-model/channels", test_channels);
	g_test_add_func("/semantic-model/tiles", test_tiles);
	g_test_add_func("/semantic-model/json", test_json);
	g_test_add_func("/semantic-model/missing", test_missing);
	g_test_add_func("/semantic-model/networks", test_networks);
	g_test_add_func("/semantic-model/cut", test_cut);
	g_test_add_func("/semantic-model/damaged", test_damaged);
	return g_test_run();
}
