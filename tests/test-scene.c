/* A model in the form that it is drawn from. */
#include "process/segment-class.h"
#include "render/scene-grey.h"
#include "render/scene-list.h"
#include "tests/scene-made.h"

/* ---- points ---- */

static void assert_place(const scene *s, const struct scene_chunk *c, uint32_t i,
	const struct model_chunk *from, const struct model_point *p)
{
	double at[3];
	scene_position(s, c, i, at);
	for (int k = 0; k < 3; k++) {
		double was = from->centre_m[k] + (double)p->position_m[k];
		double origin = fabs(from->centre_m[k] - s->origin_m[k]);
		/* Half a step, and what a float leaves of the centre and of the step. */
		double most = 0.5 * (double)c->step_m[k] + 1.2e-7 * (origin + from->half_size_m[k]);
		g_assert_cmpfloat(fabs(at[k] - was), <=, 1.01 * most + 1e-12);
	}
}

static void assert_attributes(const scene *s, uint32_t at, const struct model_point *p)
{
	g_assert_cmpmem(s->normal[at], 4, p->normal, 4);
	g_assert_cmpmem(s->direction[at], 4, p->direction, 4);
	if (p->rgba[3])
		g_assert_cmpmem(s->rgba[at], 4, p->rgba, 4);
	g_assert_cmpuint(s->kind[at], ==, p->kind);
	g_assert_cmpuint(s->degree[at], ==, p->feature);
}

/* Ranks are those of the order in which the points of the kind stand in the file. */
static void assert_ranks(const scene *s, const struct scene_chunk *c, int kind)
{
	g_autofree uint32_t *entry_of = g_new(uint32_t, c->count);
	uint32_t from = kind ? c->kind_end[kind - 1] : 0, rank = 0;
	memset(entry_of, 255, c->count * sizeof *entry_of);
	for (uint32_t n = from; n < c->kind_end[kind]; n++) {
		uint32_t entry = s->list[c->first + n], i = scene_list_index(entry);
		g_assert_cmpuint(i, <, c->count);
		g_assert_cmpuint(entry_of[i], ==, UINT32_MAX);
		entry_of[i] = entry;
		float spacing_m = scene_list_spacing_m(s, c, kind, entry);
		g_assert_cmpfloat(spacing_m, >, 0);
		g_assert_cmpfloat(spacing_m, <=, c->list_spacing_most_m[kind]);
	}
	for (uint32_t i = 0; i < c->count; i++) {
		g_assert_cmpint(s->kind[c->first + i] == kind, ==, entry_of[i] != UINT32_MAX);
		if (s->kind[c->first + i] == kind)
			g_assert_cmpuint(scene_list_rank(entry_of[i]), ==, rank++);
	}
}

static double key_of(const scene *s, const struct scene_chunk *c, int kind, uint32_t n)
{
	uint32_t entry = s->list[c->first + n],
		 many = c->kind_end[kind] - (kind ? c->kind_end[kind - 1] : 0);
	double rank = (scene_list_rank(entry) + 0.5) / many,
	       spacing_m = scene_list_spacing_m(s, c, kind, entry);
	if (kind == FEATURE_DITHER)
		spacing_m = fmax(spacing_m, scene_dither_m(s, c));
	return kind == FEATURE_DIRECTED ? rank / spacing_m : rank / (spacing_m * spacing_m);
}

/* Before the end for a key are all that have a lower one, and none with a much higher one, but for what is seldom asked for. */
static void assert_ends(const scene *s, const struct scene_chunk *c, int kind, uint32_t tone)
{
	uint32_t from = scene_list_begin(c, kind, tone),
		 end = scene_list_end(c, kind, tone, INFINITY);
	double most = 0;
	for (uint32_t n = from; n < end; n++) {
		uint32_t at = c->first + scene_list_index(s->list[c->first + n]);
		g_assert_cmpuint(scene_list_tone(kind, scene_lightness(s->rgba[at])), ==, tone);
		most = fmax(most, key_of(s, c, kind, n));
	}
	for (double part = 1e-6; part < 3 && from < end; part *= 1.37) {
		uint32_t stop = scene_list_end(c, kind, tone, (float)(part * most));
		g_assert_cmpuint(stop, >=, from);
		g_assert_cmpuint(stop, <=, end);
		for (uint32_t n = stop; n < end; n++)
			g_assert_cmpfloat(key_of(s, c, kind, n), >=, part * most);
		for (uint32_t n = from; n < stop && part > 1 / 64.; n++)
			g_assert_cmpfloat(key_of(s, c, kind, n), <=, 1.51 * part * most);
	}
	g_assert_cmpuint(scene_list_end(c, kind, tone, NAN), ==, end);
}

/* Tones lie side by side in the list, and are all of the kind. */
static void assert_tones(const scene *s, const struct scene_chunk *c, int kind)
{
	uint32_t at = kind ? c->kind_end[kind - 1] : 0;
	for (uint32_t tone = 0; tone < SCENE_LIST_TONES; tone++) {
		g_assert_cmpuint(scene_list_begin(c, kind, tone), ==, at);
		assert_ends(s, c, kind, tone);
		at = scene_list_end(c, kind, tone, INFINITY);
	}
	g_assert_cmpuint(at, ==, c->kind_end[kind]);
}

static void assert_lists(const scene *s, const struct scene_chunk *c)
{
	for (int kind = 0; kind < FEATURE_KINDS; kind++) {
		g_assert_cmpuint(c->kind_end[kind], >=, kind ? c->kind_end[kind - 1] : 0);
		g_assert_cmpuint(c->kind_end[kind], <=, c->count);
		assert_ranks(s, c, kind);
		assert_tones(s, c, kind);
	}
	g_assert_cmpuint(c->kind_end[FEATURE_KINDS - 1], ==, c->count);
}

static void assert_sizes(const scene *s, const struct scene_chunk *c)
{
	float least = INFINITY, most = 0, disc = 0;
	for (uint32_t i = c->first; i < c->first + c->count; i++) {
		g_assert_cmpuint(s->place[i].spacing, >=, 1);
		g_assert_cmpuint(s->disc[i], >=, s->place[i].spacing);
		g_assert_cmpfloat(s->disc[i], <=, 2.5f * s->place[i].spacing + 1);
		least = fminf(least, s->place[i].spacing * 1e-4f);
		most = fmaxf(most, s->place[i].spacing * 1e-4f);
		disc = fmaxf(disc, s->disc[i] * 1e-4f);
	}
	g_assert_cmpfloat(c->spacing_least_m, ==, least);
	g_assert_cmpfloat(c->spacing_most_m, ==, most);
	g_assert_cmpfloat(c->disc_most_m, ==, disc);
}

static void assert_scene(const made *m)
{
	const scene *s = m->scene;
	uint64_t chunks;
	const struct model_chunk *from = model_chunks(m->model, &chunks);
	g_assert_cmpuint(s->count, ==, model_count(m->model));
	g_assert_cmpuint(s->chunks, ==, chunks);
	for (uint32_t n = 0; n < s->chunks; n++) {
		const struct scene_chunk *c = &s->chunk[n];
		g_assert_cmpuint(c->first, ==, from[n].first);
		g_assert_cmpuint(c->count, ==, from[n].points);
		g_assert_cmpuint(c->leaf, ==, from[n].leaf);
		for (uint32_t i = 0; i < c->count; i++) {
			const struct model_point *p = &model_points(m->model)[c->first + i];
			assert_place(s, c, i, &from[n], p);
			assert_attributes(s, c->first + i, p);
		}
		assert_lists(s, c);
		assert_sizes(s, c);
	}
}

static void test_court(void)
{
	g_auto(made) m = made_court();
	const scene *s = made_read(&m);
	g_assert_cmpuint(s->chunks, >, 30);
	assert_scene(&m);
	g_assert_cmpfloat(s->dither_per_m2, ==, 60);
	g_assert_cmpfloat(s->tone_exponent, ==, 1);
	/* What its arrays really take. */
	size_t point = 3 * 2 + 2 + 2 + 4 + 4 + 4 + 1 + 1 + 2 + 2;
	g_assert_cmpuint(scene_bytes(s), ==,
		s->count * point + s->chunks * (sizeof *s->chunk + sizeof *s->list_ends) +
			sizeof *s);
}

/* Far from where the site has its origin, too. */
static void test_far_away(void)
{
	g_auto(made) m = made_new();
	struct made_plane p = { .corner_m = { -900, 1000, 300 },
		.a_m = { 3, 1, 0 },
		.b_m = { -0.4, 1.2, 2 },
		.apart_m = 0.03,
		.order = MADE_RANDOM };
	made_add_plane(&m, &p);
	p.corner_m[0] = 1000;
	made_add_plane(&m, &p);
	made_read(&m);
	assert_scene(&m);
}

/* ---- how far points of a kind stand apart ---- */

static double mean_list_spacing_m(const scene *s, int kind)
{
	double sum = 0;
	uint32_t count = 0;
	for (uint32_t n = 0; n < s->chunks; n++) {
		const struct scene_chunk *c = &s->chunk[n];
		for (uint32_t i = kind ? c->kind_end[kind - 1] : 0; i < c->kind_end[kind]; i++) {
			sum += scene_list_spacing_m(s, c, kind, s->list[c->first + i]);
			count++;
		}
	}
	g_assert_cmpuint(count, >, 0);
	return sum / count;
}

/* A quarter of the points are undirected: these stand twice as far apart. The others are surface, 3 of 4, dithering points among them. */
static void test_shares(void)
{
	g_auto(made) m = made_new();
	struct made_plane p = {
		.a_m = { 4, 0, 0 }, .b_m = { 0, 4, 0 }, .apart_m = 0.02, .order = MADE_JITTERED
	};
	made_add_plane(&m, &p);
	for (guint i = 0; i < m.points->len; i++) {
		struct made_point *q = &g_array_index(m.points, struct made_point, i);
		q->kind = i / 200 % 2 && i % 2 ? FEATURE_UNDIRECTED
			  : i % 3              ? FEATURE_NONE
					       : FEATURE_DITHER;
	}
	const scene *s = made_read(&m);
	g_assert_cmpfloat(mean_list_spacing_m(s, FEATURE_UNDIRECTED), >, 0.04 * 0.97);
	g_assert_cmpfloat(mean_list_spacing_m(s, FEATURE_UNDIRECTED), <, 0.04 * 1.03);
	for (int kind = FEATURE_NONE; kind <= FEATURE_DITHER; kind++) {
		g_assert_cmpfloat(mean_list_spacing_m(s, kind), >, 0.02 * sqrt(4 / 3.) * 0.98);
		g_assert_cmpfloat(mean_list_spacing_m(s, kind), <, 0.02 * sqrt(4 / 3.) * 1.02);
	}
}

static double mean_spacing_m(const scene *s)
{
	double sum = 0;
	for (uint32_t i = 0; i < s->count; i++)
		sum += s->place[i].spacing * 1e-4;
	return sum / s->count;
}

/* Whatever beams claim, points stand for what their discs cover, less what these cover beyond the ends of surface; but twice as many are not
 * told from two layers. */
static void test_cover(void)
{
	static const struct {
		double claimed, wanted;
	} part[] = { { 0.6, 1 }, { 0.85, 1 }, { 1, 1 }, { 1.1, 1 }, { 2, 2 * 0.866 } };
	for (size_t n = 0; n < G_N_ELEMENTS(part); n++)
		for (int axis = 0; axis < 3; axis++) {
			g_auto(made) m = made_new();
			struct made_plane p = { .apart_m = 0.02, .order = MADE_JITTERED };
			p.a_m[(axis + 1) % 3] = p.b_m[(axis + 2) % 3] = 4;
			p.b_m[axis] = 1;
			made_add_plane(&m, &p);
			for (guint i = 0; i < m.points->len; i++)
				g_array_index(m.points, struct made_point, i).claimed_m =
					(float)(0.02 * part[n].claimed);
			double spacing_m = mean_spacing_m(made_read(&m));
			g_test_message("axis %d, %.2f claimed: %.4f of %.4f m", axis,
				part[n].claimed, spacing_m, 0.02 * part[n].wanted);
			g_assert_cmpfloat(
				fabs(spacing_m / 0.02 - part[n].wanted), <, 0.11 * part[n].wanted);
		}
}

/* One plane with most of the points, and many small ones with other leaves, which have a chunk each: there they stand four times as far
 * apart. */
static void test_median(void)
{
	struct made_plane p = { .a_m = { 3, 0, 0 },
		.b_m = { 0, 3, 0 },
		.apart_m = 0.01,
		.order = MADE_RANDOM,
		.rgba = { 40, 60, 40, 255 } };
	g_auto(made) m = made_new();
	made_add_plane(&m, &p);
	p.a_m[0] = p.b_m[1] = 0.6;
	p.apart_m = 0.04;
	for (uint16_t n = 0; n < 60; n++) {
		p.corner_m[0] = 5 + n;
		p.leaf = MADE_LEAF + 1 + n;
		made_add_plane(&m, &p);
	}
	const scene *s = made_read(&m);
	g_test_message("%.1f mm in %u chunks", 1000 * (double)s->spacing_median_m, s->chunks);
	g_assert_cmpfloat(s->spacing_median_m, >, 0.008f);
	g_assert_cmpfloat(s->spacing_median_m, <, 0.013f);
}

/* A country of points 25 m apart, which no model can say. */
static void test_sparse(void)
{
	const struct made_plane plane = { .a_m = { 900, 0, 0 },
		.b_m = { 0, 600, 0 },
		.apart_m = 25,
		.order = MADE_RANDOM,
		.rgba = { 40, 60, 40, 255 } };
	g_auto(made) m = made_new();
	made_add_plane(&m, &plane);
	const scene *s = made_read(&m);
	g_assert_cmpfloat(s->unit_m, ==, SCENE_UNIT_FAR_M);
	g_assert_cmpfloat(s->spacing_median_m, >, 6.5f);
	double area_m2 = 0;
	for (uint32_t i = 0; i < s->count; i++)
		area_m2 += pow(s->place[i].spacing * (double)s->unit_m, 2);
	g_test_message("%u points stand for %.2f km2 of 0.54", s->count, area_m2 / 1e6);
	/* Discs reach beyond the ends. */
	g_assert_cmpfloat(area_m2, >, 0.9 * 540e3);
	g_assert_cmpfloat(area_m2, <, 1.6 * 540e3);
	/* Seen from above it is land, not paper. */
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"points\"}"));
	static const double eye[3] = { 450, 299, 1200 }, target[3] = { 450, 300, 0 };
	struct camera view = camera_look_at(eye, target, 30, 120, 80);
	g_autoptr(frame) f = made_frame(m.scene, d, &view);
	struct picture_buffer picture = made_picture(f);
	uint32_t covered = 0;
	for (uint32_t n = 0; n < 120 * 80; n++)
		covered += picture.rgba[n][0] < 200;
	g_test_message("%.0f %% of the picture", 100 * covered / (120 * 80.));
	g_assert_cmpuint(covered, >, 120 * 80 / 2);
	picture_buffer_clear(&picture);
}

static void test_edges(void)
{
	g_auto(made) m = made_court();
	const scene *s = made_read(&m);
	g_assert_cmpfloat(fabs(mean_list_spacing_m(s, FEATURE_DIRECTED) - 0.01), <, 1e-6);
}

/* ---- discs ---- */

static const struct measure {
	uint16_t size, spacing, plane_error;
	uint8_t kind;
	uint16_t wanted_spacing, wanted_disc;
} measures[] = {
	{ 100, 100, 10, FEATURE_NONE, 100, 100 },
	{ 100, 200, 10, FEATURE_NONE, 200, 400 },       /* aslant: long */
	{ 100, 400, 10, FEATURE_NONE, 400, 1000 },      /* but not longer than that */
	{ 100, 400, 10, FEATURE_UNDIRECTED, 140, 196 }, /* leaves */
	{ 100, 400, MODEL_ERROR_NONE, FEATURE_NONE, 140, 196 },
	{ 100, 400, 201, FEATURE_NONE, 140, 196 },
	{ 100, 400, 200, FEATURE_NONE, 400, 1000 },
	{ 200, 100, 10, FEATURE_NONE, 100, 200 }, /* beams closer one way than the other */
	{ 0, 0, 10, FEATURE_NONE, 1, 1 },
	{ 65535, 65535, 10, FEATURE_NONE, 65535, 32767 },
	{ 1, 65535, 10, FEATURE_NONE, 65535, 32767 },
	{ 1, 65535, MODEL_ERROR_NONE, FEATURE_NONE, 1, 2 },
};

static void test_measures(void)
{
	struct model_point p[G_N_ELEMENTS(measures)] = { 0 };
	for (size_t i = 0; i < G_N_ELEMENTS(p); i++) {
		p[i].size = measures[i].size;
		p[i].spacing = measures[i].spacing;
		p[i].plane_error = measures[i].plane_error;
		p[i].kind = measures[i].kind;
	}
	struct model_chunk c = { .points = G_N_ELEMENTS(p) };
	g_auto(made) m = made_of_tables(p, G_N_ELEMENTS(p), &c, 1);
	made_open(&m);
	for (size_t i = 0; i < G_N_ELEMENTS(p); i++) {
		g_assert_cmpuint(m.scene->place[i].spacing, ==, measures[i].wanted_spacing);
		g_assert_cmpuint(m.scene->disc[i], ==, measures[i].wanted_disc);
	}
}

/* ---- points without colours ---- */

enum { GREYS = 1001 };

static scene *scene_of_intensities(made *m, const uint16_t *intensity)
{
	g_autofree struct model_point *p = g_new0(struct model_point, GREYS);
	struct model_chunk c[17] = { 0 };
	for (int i = 0; i < GREYS; i++)
		p[i].intensity = intensity ? intensity[i] : 0;
	memcpy(p[5].rgba, (uint8_t[4]){ 10, 20, 30, 255 }, 4);
	for (uint64_t n = 0; n < G_N_ELEMENTS(c); n++) {
		c[n].first = n * 60;
		c[n].points = (uint32_t)MIN(60, GREYS - c[n].first);
	}
	*m = made_of_tables(p, GREYS, c, G_N_ELEMENTS(c));
	made_open(m);
	g_assert_cmpmem(m->scene->rgba[5], 4, ((uint8_t[4]){ 10, 20, 30, 255 }), 4);
	return m->scene;
}

/* They are as light as their intensities, whatever units these are in; what shines does not make all else dark. */
static void test_intensities(void)
{
	static const uint16_t least[] = { 0, 3000 }, step[] = { 1, 40 };
	for (int n = 0; n < 2; n++) {
		uint16_t intensity[GREYS];
		g_auto(made) m = { 0 };
		for (int i = 0; i < GREYS; i++)
			intensity[i] = (uint16_t)(least[n] + step[n] * i);
		intensity[1000] = 65535;
		const scene *s = scene_of_intensities(&m, intensity);
		g_assert_cmpuint(s->rgba[500][3], ==, 255);
		g_assert_cmpint(abs(s->rgba[500][0] - 136), <=, 1);
		g_assert_cmpuint(s->rgba[500][1], ==, s->rgba[500][0]);
		g_assert_cmpuint(s->rgba[0][0], ==, 48);
		g_assert_cmpuint(s->rgba[1000][2], ==, 224);
		for (int i = 7; i < GREYS; i++)
			g_assert_cmpuint(s->rgba[i][0], >=, s->rgba[i - 1][0]);
	}
}

static void test_no_intensities(void)
{
	g_auto(made) m = { 0 };
	const scene *s = scene_of_intensities(&m, NULL);
	g_assert_cmpuint(s->rgba[500][3], ==, 0);
	g_assert_cmpuint(s->rgba[500][0], ==, 154); /* it faces the sky */
}

/* Hues of classes are as light as the grey that they are of; and what has no intensity is lit. */
static void test_hues(void)
{
	static const float way[][3] = { { -0.39f, -0.53f, 0.75f }, { 0, 0, 1 }, { 1, 1, 0 } };
	uint8_t leaf_class[SEGMENT_CLASSES];
	struct scene_grey grey = { 1000, 0.02f, NULL }, dark = { 0 };
	uint8_t rgba[4], least = 255;
	for (int n = 0; n < SEGMENT_CLASSES; n++)
		leaf_class[n] = (uint8_t)n;
	for (uint16_t intensity = 900; intensity < 10000; intensity += 100)
		for (uint32_t leaf = 0; leaf < SEGMENT_CLASSES; leaf++) {
			uint8_t hue[4];
			grey.leaf_class = NULL;
			scene_grey_colour(&grey, intensity, leaf, NULL, rgba);
			g_assert_true(rgba[0] == rgba[1] && rgba[1] == rgba[2]);
			grey.leaf_class = leaf_class;
			scene_grey_colour(&grey, intensity, leaf, NULL, hue);
			g_assert_cmpint(abs(model_lightness(hue) - rgba[0]), <=, 4);
			g_assert_cmpuint(hue[3], ==, 255);
			if (leaf == CLASS_VEGETATION)
				g_assert_true(hue[1] > hue[0] && hue[0] > hue[2]);
			if (leaf == CLASS_WATER)
				g_assert_true(hue[2] > hue[1] && hue[1] > hue[0]);
		}
	for (size_t n = 0; n < G_N_ELEMENTS(way); n++) {
		int16_t normal[2];
		model_pack_normal(way[n], normal);
		scene_grey_colour(&dark, 0, 0, normal, rgba);
		g_assert_cmpuint(rgba[3], ==, 0);
		g_assert_cmpuint(rgba[0], <, least); /* each faces the light less */
		least = rgba[0];
	}
}

/* ---- odd models ---- */

static void test_no_points(void)
{
	g_auto(made) m = made_of_tables(NULL, 0, NULL, 0);
	made_open(&m);
	g_assert_cmpuint(m.scene->count, ==, 0);
	g_assert_cmpuint(m.scene->chunks, ==, 0);
}

/* A box of no size, as of one point alone. */
static void test_one_point(void)
{
	struct model_point p = { .size = 100, .spacing = 100, .kind = FEATURE_DIRECTED };
	struct model_chunk c = { .centre_m = { 5, 6, 7 }, .points = 1, .leaf = 3 };
	g_auto(made) m = made_of_tables(&p, 1, &c, 1);
	double at[3];
	made_open(&m);
	assert_scene(&m);
	scene_position(m.scene, &m.scene->chunk[0], 0, at);
	for (int k = 0; k < 3; k++)
		g_assert_cmpfloat(at[k], ==, c.centre_m[k]);
	g_assert_cmpuint(m.scene->chunk[0].kind_end[FEATURE_UNDIRECTED], ==, 0);
	g_assert_cmpuint(m.scene->chunk[0].kind_end[FEATURE_DIRECTED], ==, 1);
}

static void test_chunks_of_one(void)
{
	enum { COUNT = 500 };
	g_autofree struct model_point *p = g_new0(struct model_point, COUNT);
	g_autofree struct model_chunk *c = g_new0(struct model_chunk, COUNT);
	for (int i = 0; i < COUNT; i++) {
		p[i].spacing = p[i].size = 50;
		p[i].kind = (uint8_t)(i % FEATURE_KINDS);
		c[i] = (struct model_chunk){
			.centre_m = { i, -i, 2 * i }, .points = 1, .first = (uint64_t)i
		};
	}
	g_auto(made) m = made_of_tables(p, COUNT, c, COUNT);
	made_open(&m);
	assert_scene(&m);
}

/* All in a plane, on a line, on one place: the box has no size along some axes. */
static void test_flat(gconstpointer data)
{
	int axes = GPOINTER_TO_INT(data);
	struct model_point p[300] = { 0 };
	struct model_chunk c = { .centre_m = { 9, 9, 9 }, .points = 300 };
	g_autoptr(GRand) chance = g_rand_new_with_seed(7);
	for (int k = 0; k < axes; k++)
		c.half_size_m[k] = 1;
	for (int i = 0; i < 300; i++) {
		p[i].spacing = p[i].size = 50;
		for (int k = 0; k < axes; k++)
			p[i].position_m[k] = (float)g_rand_double_range(chance, -1, 1);
	}
	g_auto(made) m = made_of_tables(p, 300, &c, 1);
	made_open(&m);
	assert_scene(&m);
}

/* The file's checksums are right, and what it says is not. */
static void test_absurd(void)
{
	struct model_point p[4] = { { .position_m = { NAN, INFINITY, -INFINITY } },
		{ .position_m = { 1e30f, -1e30f, 3 } },
		{ .kind = 200, .normal = { INT16_MIN, 5 }, .spacing = 9 },
		{ .direction = { INT16_MIN, INT16_MIN } } };
	struct model_chunk c[2] = { { .half_size_m = { 1, 1, 1 }, .points = 2 },
		{ .centre_m = { 1e300, 0, 0 },
			.half_size_m = { 3e38f, 0, 1 },
			.points = 2,
			.first = 2 } };
	g_auto(made) m = made_of_tables(p, 4, c, 2);
	made_open(&m);
	g_autoptr(drawing) d =
		made_drawing(MADE_SITE("{\"step\":\"points\"},{\"step\":\"sprites\"},"
				       "{\"step\":\"strokes\"},{\"step\":\"edl\"}"));
	static const double eye[3] = { 0, -5, 0 }, target[3] = { 0, 0, 0 };
	struct camera view = camera_look_at(eye, target, 60, 80, 60);
	g_autoptr(frame) f = made_frame(m.scene, d, &view);
	struct picture_buffer picture = made_picture(f);
	picture_buffer_clear(&picture);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/scene/court", test_court);
	g_test_add_func("/scene/far-away", test_far_away);
	g_test_add_func("/scene/shares", test_shares);
	g_test_add_func("/scene/cover", test_cover);
	g_test_add_func("/scene/median", test_median);
	g_test_add_func("/scene/sparse", test_sparse);
	g_test_add_func("/scene/edges", test_edges);
	g_test_add_func("/scene/measures", test_measures);
	g_test_add_func("/scene/intensities", test_intensities);
	g_test_add_func("/scene/no-intensities", test_no_intensities);
	g_test_add_func("/scene/hues", test_hues);
	g_test_add_func("/scene/no-points", test_no_points);
	g_test_add_func("/scene/one-point", test_one_point);
	g_test_add_func("/scene/chunks-of-one", test_chunks_of_one);
	g_test_add_data_func("/scene/plane", GINT_TO_POINTER(2), test_flat);
	g_test_add_data_func("/scene/line", GINT_TO_POINTER(1), test_flat);
	g_test_add_data_func("/scene/place", GINT_TO_POINTER(0), test_flat);
	g_test_add_func("/scene/absurd", test_absurd);
	return g_test_run();
}
