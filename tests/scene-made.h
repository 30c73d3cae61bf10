#ifndef TESTS_SCENE_MADE_H
#define TESTS_SCENE_MADE_H
/* Small scenes whose truth is known: points on planes, along edges and in balls of leaves, written as a model's file as the product
 * writes it, in chunks along the curve, and read again by scene_new. Chance is seeded. */
#include "firmware-io/files.h"
#include "process/model-write.h"
#include "process/profile-lines.h"
#include "render/draw.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

enum { MADE_LEAF = SEGMENT_FIRST }; /* the first one; others count on */

struct made_point {
	double at_m[3];
	float normal[3], direction[3]; /* all 0: none */
	uint8_t rgba[4];
	uint8_t kind, degree;
	uint16_t leaf;
	float apart_m;
	float claimed_m;          /* spacing that its beam claims; 0: apart_m */
	float k[2], principal[3]; /* curvatures, 1/m, and the way of the first; all 0: none */
};

typedef struct made made;
struct made {
	GArray *points; /* of struct made_point */
	GRand *chance;
	float dither_per_m2, tone_exponent;
	char *folder, *path; /* of the file, when there is one */
	model *model;
	scene *scene; /* from made_read on */
};

static inline made made_new(void)
{
	return (made){ .points = g_array_new(FALSE, TRUE, sizeof(struct made_point)),
		.chance = g_rand_new_with_seed(4096),
		.dither_per_m2 = 60,
		.tone_exponent = 1 };
}

static inline void made_clear(made *m)
{
	g_clear_pointer(&m->scene, scene_free);
	g_clear_pointer(&m->model, model_free);
	g_clear_pointer(&m->points, g_array_unref);
	g_clear_pointer(&m->chance, g_rand_free);
	if (m->folder)
		files_remove_tree(m->folder, NULL);
	g_clear_pointer(&m->folder, g_free);
	g_clear_pointer(&m->path, g_free);
}
G_DEFINE_AUTO_CLEANUP_CLEAR_FUNC(made, made_clear)

/* ---- surfaces ---- */

enum made_order { MADE_REGULAR, MADE_JITTERED, MADE_RANDOM };

struct made_plane {
	double corner_m[3], a_m[3], b_m[3]; /* it faces along a x b */
	double apart_m;
	enum made_order order;
	uint8_t rgba[4];
	uint16_t leaf;  /* 0: MADE_LEAF */
	bool no_normal; /* it has one */
	bool dithered;  /* some of its points, by the lightness */
};

static inline void made_normal(const struct made_plane *p, float ret[3])
{
	double n[3];
	for (int k = 0; k < 3; k++)
		n[k] = p->a_m[(k + 1) % 3] * p->b_m[(k + 2) % 3] -
		       p->a_m[(k + 2) % 3] * p->b_m[(k + 1) % 3];
	double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
	for (int k = 0; k < 3; k++)
		ret[k] = (float)(n[k] / length);
}

static inline double made_length(const double v[3])
{
	return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static inline float made_lightness(const uint8_t rgba[4])
{
	return (float)(77 * rgba[0] + 150 * rgba[1] + 29 * rgba[2]) / 256 / 255;
}

/* Where the point of a row and column is: 0..1 along both edges. */
static inline void made_place(
	const made *m, const struct made_plane *p, int i, int n, int j, int k, double ret[2])
{
	double jitter[2] = { 0.5, 0.5 };
	if (p->order == MADE_JITTERED)
		for (int axis = 0; axis < 2; axis++)
			jitter[axis] = g_rand_double(m->chance);
	ret[0] = (i + jitter[0]) / n;
	ret[1] = (j + jitter[1]) / k;
	if (p->order == MADE_RANDOM)
		for (int axis = 0; axis < 2; axis++)
			ret[axis] = g_rand_double(m->chance);
}

/* Floyd and Steinberg's error diffusion over the rows of the plane, as in features-dither.c: which points are dithering points. */
struct made_dither {
	float *error; /* of a row and the next one, with a column on either side */
	int columns;
};

static inline bool made_dithers(struct made_dither *d, int row, int column, float wanted)
{
	float *here = d->error + row % 2 * (d->columns + 2) + column + 1,
	      *next = d->error + (row + 1) % 2 * (d->columns + 2) + column + 1;
	float sum = wanted + *here, left;
	bool yes = sum > 0.5f;
	left = sum - (yes ? 1 : 0);
	*here = 0;
	here[1] += left * 7 / 16;
	next[-1] += left * 3 / 16;
	next[0] += left * 5 / 16;
	next[1] += left / 16;
	return yes;
}

static inline void made_add_plane(made *m, const struct made_plane *p)
{
	double ea = made_length(p->a_m), eb = made_length(p->b_m), at[2];
	int n = MAX((int)lround(ea / p->apart_m), 1), k = MAX((int)lround(eb / p->apart_m), 1);
	g_autofree float *error = g_new0(float, 2 * (k + 2));
	struct made_dither d = { error, k };
	struct made_point q = { .leaf = p->leaf ? p->leaf : MADE_LEAF,
		.apart_m = (float)p->apart_m };
	float wanted = m->dither_per_m2 * (float)(p->apart_m * p->apart_m) *
		       powf(1 - made_lightness(p->rgba), m->tone_exponent);
	if (!p->no_normal)
		made_normal(p, q.normal);
	memcpy(q.rgba, p->rgba, 4);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < k; j++) {
			made_place(m, p, i, n, j, k, at);
			for (int axis = 0; axis < 3; axis++)
				q.at_m[axis] = p->corner_m[axis] + at[0] * p->a_m[axis] +
					       at[1] * p->b_m[axis];
			q.kind = p->dithered && made_dithers(&d, i, j, wanted) ? FEATURE_DITHER
									       : FEATURE_NONE;
			g_array_append_val(m->points, q);
		}
}

/* Directed feature points along a line, in a ridge two points wide, as features.h leaves them. */
static inline void made_add_edge(made *m, const double from_m[3], const double to_m[3],
	const float normal[3], double apart_m)
{
	double along[3], length;
	for (int k = 0; k < 3; k++)
		along[k] = to_m[k] - from_m[k];
	length = made_length(along);
	int n = (int)lround(length / apart_m * 2);
	struct made_point p = { .rgba = { 128, 128, 128, 255 },
		.kind = FEATURE_DIRECTED,
		.degree = 255,
		.leaf = MADE_LEAF,
		.apart_m = (float)apart_m };
	for (int i = 0; i < n; i++) {
		double t = g_rand_double(m->chance);
		for (int k = 0; k < 3; k++) {
			p.at_m[k] = from_m[k] + t * along[k] +
				    g_rand_double_range(m->chance, -0.1, 0.1) * apart_m;
			p.normal[k] = normal[k];
			p.direction[k] = (float)(along[k] / length);
		}
		g_array_append_val(m->points, p);
	}
}

/* Leaves: undirected feature points without planes, anywhere in a ball. */
static inline void made_add_ball(
	made *m, const double middle_m[3], double radius_m, int count, uint16_t leaf)
{
	struct made_point p = { .rgba = { 60, 120, 40, 255 },
		.kind = FEATURE_UNDIRECTED,
		.degree = 200,
		.leaf = leaf,
		.apart_m = 0.02f };
	for (int i = 0; i < count;) {
		double v[3];
		for (int k = 0; k < 3; k++)
			v[k] = g_rand_double_range(m->chance, -1, 1);
		if (made_length(v) > 1)
			continue;
		for (int k = 0; k < 3; k++)
			p.at_m[k] = middle_m[k] + radius_m * v[k];
		g_array_append_val(m->points, p);
		i++;
	}
}

/* So many points on a ball, as even as a spiral; bent as it is. rgba all 0: without a colour. */
static inline void made_add_sphere(
	made *m, const double middle_m[3], double radius_m, uint32_t count, const uint8_t rgba[4])
{
	struct made_point p = { .leaf = MADE_LEAF,
		.apart_m = (float)(radius_m * sqrt(4 * G_PI / count)),
		.k = { (float)(1 / radius_m), (float)(1 / radius_m) } };
	memcpy(p.rgba, rgba, 4);
	for (uint32_t i = 0; i < count; i++) {
		double z = 1 - (2 * i + 1.0) / count, turn = i * G_PI * (3 - sqrt(5));
		double r = sqrt(1 - z * z), out[3] = { r * cos(turn), r * sin(turn), z };
		for (int k = 0; k < 3; k++) {
			p.at_m[k] = middle_m[k] + radius_m * out[k];
			p.normal[k] = (float)out[k];
		}
		p.principal[0] = (float)-sin(turn);
		p.principal[1] = (float)cos(turn);
		g_array_append_val(m->points, p);
	}
}

/* Ground of 6 x 6 m, dithered; a wall 3 m behind with its upper edge; a ball of leaves before it, which is another leaf of the tree. */
static inline made made_court(void)
{
	made m = made_new();
	struct made_plane ground = { .corner_m = { 100, 200, 3 },
		.a_m = { 6, 0, 0 },
		.b_m = { 0, 6, 0 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 90, 80, 70, 255 },
		.dithered = true };
	struct made_plane wall = { .corner_m = { 100, 205, 3 },
		.a_m = { 6, 0, 0 },
		.b_m = { 0, 0, 2.5 },
		.apart_m = 0.02,
		.order = MADE_JITTERED,
		.rgba = { 200, 190, 180, 255 },
		.dithered = true };
	static const double left[3] = { 100, 205, 5.5 }, right[3] = { 106, 205, 5.5 };
	static const double tree[3] = { 102, 203, 4.2 };
	static const float south[3] = { 0, -1, 0 };
	made_add_plane(&m, &ground);
	made_add_plane(&m, &wall);
	made_add_edge(&m, left, right, south, 0.02);
	made_add_ball(&m, tree, 0.6, 9000, MADE_LEAF + 1);
	return m;
}

/* A profile line of MADE_LEAF; the face beside it looks south. */
static inline void made_add_line(profile_lines *p, int kind, double x, double y, double z,
	double to_x, double to_y, double to_z)
{
	const double at[2][3] = { { x, y, z }, { to_x, to_y, to_z } };
	static const float south[3] = { 0, -1, 0 };
	struct profile_line l = { .first = p->vertex->len,
		.count = 2,
		.confidence = 1,
		.leaf = MADE_LEAF,
		.kind = (uint8_t)kind };
	double way[3];
	for (int n = 0; n < 2; n++) {
		struct profile_vertex v = { .face[1] = { MODEL_NORMAL_NONE, MODEL_NORMAL_NONE } };
		model_pack_normal(south, v.face[0]);
		for (int k = 0; k < 3; k++) {
			v.at_m[k] = (float)(at[n][k] - p->origin_m[k]);
			way[k] = at[1][k] - at[0][k];
		}
		g_array_append_val(p->vertex, v);
	}
	l.length_m = (float)made_length(way);
	g_array_append_val(p->line, l);
}

/* ---- files ---- */

static inline struct part_point made_pack(const struct made_point *p)
{
	struct morton_place place;
	struct part_point q = { .leaf = p->leaf,
		.feature = p->degree,
		.kind = p->kind,
		.size = (uint16_t)CLAMP(p->apart_m * 1e4f + 0.5f, 1, 65535),
		.spacing = (uint16_t)CLAMP(
			(p->claimed_m > 0 ? p->claimed_m : p->apart_m) * 1e4f + 0.5f, 1, 65535),
		.plane_error = p->kind == FEATURE_UNDIRECTED ? MODEL_ERROR_NONE : 10,
		.k1 = MODEL_HALF_NONE,
		.k2 = MODEL_HALF_NONE };
	g_assert_true(morton_from_point(p->at_m, morton_cell_m(0), &place));
	q.code = place.code;
	memcpy(q.within, place.within, sizeof q.within);
	memcpy(q.rgba, p->rgba, sizeof q.rgba);
	model_pack_normal(p->normal, q.normal);
	model_pack_normal(p->direction, q.direction);
	model_pack_normal(p->principal, q.principal);
	if (p->k[0] != 0) {
		q.k1 = model_pack_half(p->k[0]);
		q.k2 = model_pack_half(p->k[1]);
	}
	return q;
}

static inline int made_compare(const void *a, const void *b)
{
	return part_point_compare(a, b);
}

static inline JsonObject *made_manifest(const made *m)
{
	JsonObject *o = json_object_new();
	json_object_set_double_member(o, "dither_per_m2", (double)m->dither_per_m2);
	json_object_set_double_member(o, "tone_exponent", (double)m->tone_exponent);
	json_object_set_member(o, "made_from",
		json_from_string("[{\"scan\":1,\"pose\":[1,0,0,0,1,0,0,0,1,103,201,4.6]}]", NULL));
	return o;
}

static inline void made_write_to(made *m, const char *path)
{
	g_autoptr(GError) error = NULL;
	g_autofree struct part_point *p = g_new(struct part_point, m->points->len + 1);
	for (guint i = 0; i < m->points->len; i++)
		p[i] = made_pack(&g_array_index(m->points, struct made_point, i));
	qsort(p, m->points->len, sizeof *p, made_compare);
	g_autoptr(model_writer) w = model_writer_new(path, 0, &error);
	g_assert_no_error(error);
	for (guint i = 0; i < m->points->len; i++)
		g_assert_true(model_writer_add(w, &p[i], 1, NULL));
	g_assert_true(model_writer_finish(w, NULL, 0, made_manifest(m), &error));
	g_assert_no_error(error);
}

static inline void made_find_folder(made *m)
{
	g_autoptr(GError) error = NULL;
	m->folder = g_dir_make_tmp("test-scene-XXXXXX", &error);
	g_assert_no_error(error);
	m->path = g_build_filename(m->folder, "points.model", NULL);
}

static inline void made_open(made *m)
{
	g_autoptr(GError) error = NULL;
	m->model = model_open_file(m->path, &error);
	g_assert_no_error(error);
	m->scene = scene_new(m->model, &error);
	g_assert_no_error(error);
}

/* Writes and reads it. */
static inline const scene *made_read(made *m)
{
	made_find_folder(m);
	made_write_to(m, m->path);
	made_open(m);
	return m->scene;
}

/* A file of just these points and chunks. */
static inline made made_of_tables(const struct model_point *point, size_t count,
	const struct model_chunk *chunk, size_t chunks)
{
	made m = made_new();
	made_find_folder(&m);
	g_autoptr(product_writer) w = product_writer_new(m.path, NULL);
	g_assert_true(product_writer_begin(w, "points", sizeof *point, NULL));
	g_assert_true(product_writer_append(w, point, count, NULL));
	g_assert_true(product_writer_begin(w, "chunks", sizeof *chunk, NULL));
	g_assert_true(product_writer_append(w, chunk, chunks, NULL));
	g_assert_true(product_writer_finish(w, MODEL_KIND, MODEL_VERSION, made_manifest(&m), NULL));
	return m;
}

/* ---- how they are drawn ---- */

/* MADE_LEAF is "Yard", of the buildings; MADE_LEAF + 1 "Tree", of the vegetation. */
static inline segments *made_tree(void)
{
	segments *s = segments_new();
	g_assert_cmpuint(
		segments_add(s, segment_of_class(CLASS_BUILDING), "Yard", "user"), ==, MADE_LEAF);
	g_assert_cmpuint(segments_add(s, segment_of_class(CLASS_VEGETATION), "Tree", "user"), ==,
		MADE_LEAF + 1);
	return s;
}

/* On even white paper. nodes: "site":{"steps":[...]} and others. */
static inline drawing *made_drawing(const char *nodes)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strdup_printf(
		"{\"schema\":1,\"paper\":{\"colour\":\"#ffffff\",\"grain\":0},\"segments\":{%s}}",
		nodes);
	g_autoptr(style) s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	g_autoptr(segments) tree = made_tree();
	drawing *d = drawing_new(s, tree, NULL, &error);
	g_assert_no_error(error);
	return d;
}

#define MADE_SITE(steps) "\"site\":{\"steps\":[" steps "]}"

static inline frame *made_frame(const scene *s, const drawing *d, const struct camera *c)
{
	g_autoptr(GError) error = NULL;
	frame *f = frame_new(s, d, c, &error);
	g_assert_no_error(error);
	return f;
}

/* Caller clears it. */
static inline struct picture_buffer made_picture(const frame *f)
{
	struct picture_buffer p = picture_buffer_new(f->camera.width, f->camera.height);
	draw_frame(NULL, f, &p, NULL);
	return p;
}

static inline void made_assert_same(const struct picture_buffer *a, const struct picture_buffer *b)
{
	size_t bytes = (size_t)4 * a->width * a->height, differ = 0;
	const uint8_t *p = (const uint8_t *)a->rgba, *q = (const uint8_t *)b->rgba;
	g_assert_cmpuint(a->width, ==, b->width);
	g_assert_cmpuint(a->height, ==, b->height);
	for (size_t i = 0; i < bytes; i++)
		differ += p[i] != q[i];
	g_assert_cmpuint(differ, ==, 0);
}

/* With any vectors, on one thread and on all. */
static inline void made_assert_same_on_any(frame *f)
{
	f->lanes = LANES_PORTABLE;
	struct picture_buffer first = made_picture(f);
	for (enum lanes_path path = LANES_PORTABLE; path <= lanes_path_widest(); path++)
		for (int single = 0; single < 2; single++) {
			f->lanes = path;
			f->single_thread = single;
			struct picture_buffer again = made_picture(f);
			made_assert_same(&first, &again);
			picture_buffer_clear(&again);
		}
	picture_buffer_clear(&first);
}

/* One that all tests of a program look at; never freed. */
static inline const scene *made_shared_court(void)
{
	static made m;
	if (!m.scene) {
		m = made_court();
		made_read(&m);
		files_remove_tree(m.folder, NULL); /* it stays mapped */
	}
	return m.scene;
}

#endif
