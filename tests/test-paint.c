/* Brush strokes on a wall with an edge and before it a tree: whether they cover it, where they lie, how large they are, which of them is
 * seen. */
#include "render/bands.h"
#include "render/light.h"
#include "tests/strokes-made.h"

#define SIDE 600u

/* A wall of 4 x 4 m that is seen from the south; an edge goes up its middle, aslant. */
static const double middle_m[3] = { 102, 205, 5 };

static made wall_of(uint8_t grey, bool has_edge)
{
	made m = made_new();
	struct made_plane wall = { .corner_m = { 100, 205, 3 },
		.a_m = { 4, 0, 0 },
		.b_m = { 0, 0, 4 },
		.apart_m = 0.01,
		.order = MADE_JITTERED,
		.rgba = { grey, grey, grey, 255 } };
	static const double low[3] = { 101.5, 205, 3.5 }, high[3] = { 102.5, 205, 6.5 };
	static const float south[3] = { 0, -1, 0 };
	made_add_plane(&m, &wall);
	if (has_edge)
		made_add_edge(&m, low, high, south, 0.01);
	return m;
}

static const scene *shared_wall(void)
{
	static made m;
	if (!m.scene) {
		m = wall_of(120, true);
		made_read(&m);
		files_remove_tree(m.folder, NULL); /* it stays mapped */
	}
	return m.scene;
}

static struct camera before_wall(double away_m, double aside_m)
{
	double eye[3] = { middle_m[0] + aside_m, middle_m[1] - away_m, middle_m[2] };
	return camera_look_at(eye, middle_m, 50, SIDE, SIDE);
}

/* On paper of a colour that no paint has, without what differs by chance. fields: more of the only step. */
static drawing *paint(const char *sections, const char *fields)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *text = g_strdup_printf(
		"{\"schema\":1,\"paper\":{\"colour\":\"#ff00ff\",\"grain\":0},%s\"segments\":{"
		"\"site\":{\"steps\":[{\"step\":\"paint\",\"tooth\":0%s%s}]}}}",
		sections, *fields ? "," : "", fields);
	g_autoptr(style) s = style_parse(text, -1, "made.json", &error);
	g_assert_no_error(error);
	drawing *d = drawing_new(s, NULL, NULL, &error);
	g_assert_no_error(error);
	return d;
}

/* ---- what it covers ---- */

/* Of the pixels that show the wall the part that is still more paper than paint. */
static double bare_part(const char *fields, double away_m, double aside_m)
{
	struct camera c = before_wall(away_m, aside_m);
	g_autoptr(drawing) d = paint("", fields);
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c);
	uint32_t count, wall = 0, bare = 0;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	g_autoptr(visibility_mask) m = visibility_mask_new(f, views, count);
	struct picture_buffer p = made_picture(f);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++) {
			const uint8_t *rgba = p.rgba[y * SIDE + x];
			if (mask_key(m, (int32_t)x, (int32_t)y) >= MASK_EMPTY)
				continue;
			wall++;
			bare += rgba[0] > rgba[1] + 60;
		}
	picture_buffer_clear(&p);
	g_assert_cmpuint(wall, >, SIDE * SIDE / 20);
	return (double)bare / wall;
}

static void test_covers(void)
{
	static const double from[][2] = { { 3, 0 }, { 8, 0 }, { 0.8, 0.4 }, { 3, 6 } };
	for (size_t n = 0; n < G_N_ELEMENTS(from); n++) {
		double bare = bare_part("", from[n][0], from[n][1]),
		       open = bare_part("\"gap_px\":0", from[n][0], from[n][1]),
		       thick = bare_part("\"cover\":6,\"gap_px\":0", from[n][0], from[n][1]),
		       thin = bare_part(
			       "\"cover\":0.5,\"detail\":1,\"gap_px\":0", from[n][0], from[n][1]);
		g_test_message(
			"from %g, %g m: bare %.3f %%, %.2f %% with gaps, %.3f %% where thick, "
			"%.1f %% where thin",
			from[n][0], from[n][1], 100 * bare, 100 * open, 100 * thick, 100 * thin);
		g_assert_cmpfloat(bare, <, 0.02);
		g_assert_cmpfloat(open, >, 0.005);
		g_assert_cmpfloat(thick, <, 0.006);
		g_assert_cmpfloat(thin, >, 0.15);
		g_assert_cmpfloat(thin, <, 0.7);
	}
}

/* Gaps take the colour of the paint beside them, where the wall is; and nothing else changes. */
static void test_gaps(void)
{
	static const char fields[] = "\"thickness_px\":0,\"shine\":0,\"light_variation\":0,"
				     "\"hue_variation_deg\":0,\"warmth\":0,\"gap_px\":%d";
	g_autofree char *none = g_strdup_printf(fields, 0), *some = g_strdup_printf(fields, 12);
	struct camera c = before_wall(8, 0);
	g_autoptr(drawing) d = paint("", none), e = paint("", some);
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c), g = made_frame(shared_wall(), e, &c);
	uint32_t count, filled = 0, left = 0;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	g_autoptr(visibility_mask) m = visibility_mask_new(f, views, count);
	struct picture_buffer open = made_picture(f), closed = made_picture(g);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++) {
			const uint8_t *was = open.rgba[y * SIDE + x],
				      *is = closed.rgba[y * SIDE + x];
			bool of_wall = mask_key(m, (int32_t)x, (int32_t)y) < MASK_EMPTY;
			left += of_wall && is[0] > is[1] + 60;
			if (memcmp(was, is, 4) == 0)
				continue;
			/* On magenta, and not any more. */
			g_assert_true(of_wall);
			g_assert_cmpint(is[0] - is[1], <, was[0] - was[1]);
			filled += was[0] - was[1] > 200 && abs(is[0] - is[1]) <= 1;
		}
	g_test_message("%u pixels filled, %u left", filled, left);
	g_assert_cmpuint(filled, >, 500);
	g_assert_cmpuint(left, <, filled / 10);
	picture_buffer_clear(&open);
	picture_buffer_clear(&closed);
}

/* ---- where it lies, how large it is ---- */

static bool is_of_edge(const scene *s, const struct stroke *stroke)
{
	return s->kind[stroke->point] == FEATURE_DIRECTED;
}

/* Level on the wall, along the edge on it; and what is beside it turns along too. */
static void test_ways(void)
{
	struct camera c = before_wall(4, 0);
	g_autoptr(drawing) d = paint("", "\"angle_variation_deg\":0,\"detail\":0");
	g_autoptr(drawing) heedless = paint("", "\"angle_variation_deg\":0,\"follow\":0");
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c),
			 g = made_frame(shared_wall(), heedless, &c);
	stroke_list *l = strokes_of(f, true);
	double rise = 3 / sqrt(10), run = 1 / sqrt(10);
	uint32_t edge = 0, level = 0, turned = 0;
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		double along = fabs((double)s->along[0] * run - (double)s->along[1] * rise);
		if (is_of_edge(f->scene, s)) {
			g_assert_cmpfloat(along, >, 0.999);
			edge++;
		} else if (fabsf(s->along[0]) > 0.999f)
			level++;
		else {
			g_assert_cmpfloat(along, >, 0.999);
			turned++;
		}
	}
	g_test_message("%u of the edge, %u beside it, %u level", edge, turned, level);
	g_assert_cmpuint(edge, >, 100);
	g_assert_cmpuint(turned, >, edge / 2);
	g_assert_cmpuint(level, >, 3 * turned);
	stroke_lists_free(l, f->layers);
	l = strokes_of(g, true);
	for (uint32_t n = 0; n < l->count; n++)
		g_assert_cmpfloat(fabsf(l->stroke[n].along[0]), >, 0.999f);
	stroke_lists_free(l, g->layers);
}

/* Copies have points that are the same. */
static struct stroke *by_point(const stroke_list *l, const scene *s)
{
	struct stroke *ret = g_new0(struct stroke, s->count);
	for (uint32_t n = 0; n < l->count; n++)
		if (!l->stroke[n].copy)
			ret[l->stroke[n].point] = l->stroke[n];
	return ret;
}

/* Nearer by a tenth, strokes grow somewhat more than what they are on does, but for the broadest; none comes or goes in between. */
static void test_sizes(void)
{
	struct camera far = before_wall(4.4, 0), near = before_wall(4, 0);
	g_autoptr(drawing) d = paint("", "\"length_variation\":0,\"detail\":0,\"scatter\":0");
	g_autoptr(frame) f = made_frame(shared_wall(), d, &far),
			 g = made_frame(shared_wall(), d, &near);
	stroke_list *before = strokes_of(f, true), *after = strokes_of(g, true);
	g_autofree struct stroke *there = by_point(after, g->scene);
	float broadest = 0.5f * f->layer[0].ink.length_px;
	uint32_t grew = 0, stayed = 0;
	for (uint32_t n = 0; n < before->count; n++) {
		const struct stroke *s = &before->stroke[n], *t = &there[s->point];
		if (fabsf(s->x_px - SIDE / 2.f) > 200 || fabsf(s->y_px - SIDE / 2.f) > 200)
			continue;
		g_assert_cmpfloat(t->alpha, >=, s->alpha * 0.95f);
		float by = t->half_length_px / s->half_length_px;
		g_assert_cmpfloat(t->half_length_px, <, 1.01f * broadest);
		if (t->half_length_px > 0.99f * broadest || s->alpha < 0.5f) {
			stayed++;
			continue;
		}
		g_assert_cmpfloat(by, >, 1.05f);
		g_assert_cmpfloat(by, <, 1.2f);
		grew++;
	}
	g_test_message("%u grew, %u stayed", grew, stayed);
	g_assert_cmpuint(grew, >, 200);
	stroke_lists_free(before, f->layers);
	stroke_lists_free(after, g->layers);
}

/* Fine strokes are where the edge is, and nowhere else. */
static void test_detail(void)
{
	struct camera c = before_wall(5, 0);
	g_autoptr(drawing) d = paint("", "\"length_variation\":0,\"detail\":1,\"fine\":0.2");
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c);
	stroke_list *l = strokes_of(f, true);
	double sum[2] = { 0 }, count[2] = { 0 };
	for (uint32_t n = 0; n < l->count; n++) {
		bool of_edge = is_of_edge(f->scene, &l->stroke[n]);
		sum[of_edge] += (double)l->stroke[n].half_length_px;
		count[of_edge]++;
	}
	g_test_message("%.0f strokes of %.1f px, %.0f of the edge of %.1f px", count[0],
		2 * sum[0] / count[0], count[1], 2 * sum[1] / count[1]);
	g_assert_cmpfloat(sum[1] / count[1], <, 0.5 * sum[0] / count[0]);
	stroke_lists_free(l, f->layers);
}

/* No paint is where its texture is thicker than it is dry, but inside of its extents. */
static void test_extents(void)
{
	struct camera c = before_wall(4, 0);
	g_autoptr(drawing) d = paint("", "");
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c);
	uint32_t narrower = 0;
	for (uint32_t n = 0; n < PAINT_LEVELS; n++) {
		const struct paint_level *l = &f->layer[0].paint->level[n];
		const stroke_texture *t = l->texture;
		for (uint32_t v = 0; v < t->variants; v++)
			for (uint32_t step = 0; step < PAINT_DRY_STEPS; step++) {
				const struct paint_extent *e = &l->extent[v][step];
				const uint8_t *texel = stroke_texture_variant(t, v);
				narrower += e->reach[0] < 1;
				for (uint32_t y = 0; y < t->width; y++)
					for (uint32_t x = 0; x < t->length; x++) {
						if (*texel++ * PAINT_DRY_STEPS <= step * 255)
							continue;
						/* And all that is less than a texel away from it. */
						float along = (2 * (float)x + 1) /
								      (float)t->length -
							      1,
						      across =
							      (2 * (float)y + 1) / (float)t->width -
							      1;
						g_assert_cmpfloat(fabsf(along - e->middle[0]) +
									  2 / (float)t->length,
							<=, e->reach[0] + 1e-5f);
						g_assert_cmpfloat(fabsf(across - e->middle[1]) +
									  2 / (float)t->width,
							<=, e->reach[1] + 1e-5f);
					}
			}
	}
	g_assert_cmpuint(narrower, >, PAINT_DRY_STEPS);
}

/* ---- which is seen ---- */

/* Those that come in lie lower than the others. */
static void test_rises(void)
{
	struct camera c = before_wall(9, 0);
	g_autoptr(drawing) d = paint("", "\"detail\":0");
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c);
	stroke_list *l = strokes_of(f, true);
	uint32_t low = 0, high = 0;
	for (uint32_t n = 0; n < l->count; n++) {
		const struct stroke *s = &l->stroke[n];
		float least = PAINT_LAYS * PAINT_LAY_RISE * s->alpha,
		      most = least + PAINT_LAYS * (1 - PAINT_LAY_RISE);
		g_assert_cmpfloat(s->lay, >, least - 1);
		g_assert_cmpfloat(s->lay, <, most);
		low += s->alpha < 0.3f;
		high += s->alpha > 0.5f && s->lay > PAINT_LAYS * (1 - PAINT_LAY_RISE);
	}
	g_test_message("of %u strokes %u come in, %u lie high", l->count, low, high);
	g_assert_cmpuint(low, >, 50);
	g_assert_cmpuint(high, >, 50);
	stroke_lists_free(l, f->layers);
}

/* Points that are black or white by chance: paint is as well, where it is dry. */
static double grey_part(const scene *s, const char *fields)
{
	struct camera c = before_wall(4, 0);
	g_autoptr(drawing) d = paint("", fields);
	g_autoptr(frame) f = made_frame(s, d, &c);
	struct picture_buffer p = made_picture(f);
	uint32_t grey = 0;
	for (size_t n = 0; n < (size_t)SIDE * SIDE; n++)
		grey += p.rgba[n][1] > 70 && p.rgba[n][1] < 235;
	picture_buffer_clear(&p);
	return (double)grey / (SIDE * SIDE);
}

static void test_hides(void)
{
	g_auto(made) m = wall_of(0, false);
	for (guint n = 0; n < m.points->len; n++)
		memset(g_array_index(m.points, struct made_point, n).rgba,
			g_rand_boolean(m.chance) ? 255 : 0, 3);
	made_read(&m);
	static const char own[] =
		"\"cover\":5,\"even\":0,\"warmth\":0,\"light_variation\":0,\"thickness_px\":"
		"0,\"shine\":0,\"wet\":%d";
	g_autofree char *dry = g_strdup_printf(own, 0), *wet = g_strdup_printf(own, 1);
	double few = grey_part(m.scene, dry), many = grey_part(m.scene, wet);
	g_test_message(
		"grey: %.1f %% where it is dry, %.1f %% where it is wet", 100 * few, 100 * many);
	g_assert_cmpfloat(few, <, 0.55);
	g_assert_cmpfloat(many, >, 0.7);
}

/* ---- the same ---- */

#define LIT "\"light\":{\"amount\":0.7,\"azimuth_deg\":250,\"elevation_deg\":35},"
#define ALL                                                                                        \
	"\"palette\":[\"#e02020\",\"#f0e020\",\"#2030c0\"],\"shine\":0.4,\"thickness_px\":3,"      \
	"\"warmth\":0.7,\"hue_variation_deg\":30,\"light_variation\":0.4"

static void test_lanes(void)
{
	g_auto(made) m = made_court();
	made_read(&m);
	double at[3] = { 103, 203, 4.2 }, eye[3] = { 103.5, 198, 5 };
	struct camera c = camera_look_at(eye, at, 60, 500, 400);
	g_autoptr(drawing) d = paint(LIT, ALL);
	g_autoptr(frame) f = made_frame(m.scene, d, &c);
	made_assert_same_on_any(f);
}

/* Sums of a band of strokes, in their order or the other way round. */
struct sums {
	float *plane[6];
	struct band_parts laid;
};

static struct sums sums_of(const frame *f, const struct band *b, const struct band_strokes *strokes)
{
	struct sums s = { .laid = { .shift = 4 } };
	for (int k = 0; k < 6; k++)
		s.plane[k] = g_new0(float, (size_t)b->pitch * b->rows);
	for (size_t n = 0; n < (size_t)b->pitch * b->rows; n++)
		s.plane[0][n] = 1;
	struct band_ink ink = { .bare = s.plane[0],
		.channel = { s.plane[1], s.plane[2], s.plane[3] },
		.weight = s.plane[4],
		.height = s.plane[5],
		.laid = &s.laid };
	band_draw(b, f, &f->layer[0], strokes, NULL, &ink);
	return s;
}

static int byte_of(const struct sums *s, int k, size_t at)
{
	float light = s->plane[1 + k][at] / s->plane[4][at];
	return (int)(255 * light_to_srgb(light) + 0.5f);
}

static void test_order(void)
{
	struct camera c = before_wall(4, 0);
	g_autoptr(drawing) d = paint(LIT, ALL);
	g_autoptr(frame) f = made_frame(shared_wall(), d, &c);
	uint32_t views;
	g_autofree struct chunk_view *view = chunk_views_new(f, &views);
	g_autoptr(visibility_mask) mask = visibility_mask_new(f, view, views);
	g_autoptr(stroke_room) room = stroke_room_new();
	const struct stroke_blocks *all = stroke_room_fill(room, f, mask, view, views);
	g_autofree uint32_t *in_order = g_new(uint32_t, all->count),
			    *back = g_new(uint32_t, all->count);
	for (uint32_t k = 0, at = 0; k < all->blocks; k++)
		for (uint32_t n = 0; n < all->block[k]->count; n++, at++)
			in_order[at] = back[all->count - 1 - at] = k << BAND_STROKE_BITS | n;
	struct band b = { SIDE, 320, BAND_ROWS, SIDE + 2 * BAND_MARGIN };
	struct sums one = sums_of(
			    f, &b, &(struct band_strokes){ in_order, all->count, all->block }),
		    two = sums_of(f, &b, &(struct band_strokes){ back, all->count, all->block });
	int most = 0;
	for (uint32_t y = b.from; y < b.from + b.rows; y++)
		for (uint32_t x = 0; x < SIDE; x++) {
			size_t at = (size_t)(&band_row(&b, one.plane[4], y)[x] - one.plane[4]);
			if (!(one.laid.in >> (x >> one.laid.shift) & 1))
				g_assert_cmpfloat(one.plane[4][at], ==, 0);
			for (int k = 0; k < 3 && one.plane[4][at] > 0; k++)
				most = MAX(most, abs(byte_of(&one, k, at) - byte_of(&two, k, at)));
		}
	g_assert_cmpint(most, <=, 1);
	g_assert_true(one.laid.in == two.laid.in && one.laid.in);
	for (int k = 0; k < 6; k++) {
		g_free(one.plane[k]);
		g_free(two.plane[k]);
	}
}

/* What is seen of points is there as long as something is painted, and until something is drawn that is not. */
static void test_forgets(void)
{
	g_auto(made) m = made_court();
	const scene *s = made_read(&m);
	double at[3] = { 103, 203, 4.2 }, eye[3] = { 103.5, 198, 5 };
	struct camera c = camera_look_at(eye, at, 60, 300, 240);
	g_autoptr(drawing) painted = paint(LIT, ALL);
	g_autoptr(drawing) inked = made_drawing(MADE_SITE("{\"step\":\"lines\"}"));
	g_assert_false(scene_paint_is_there(s));
	frame *f = made_frame(s, painted, &c);
	struct picture_buffer first = made_picture(f);
	frame_free(made_frame(s, inked, &c));
	g_assert_true(scene_paint_is_there(s));
	frame_free(f);
	g_assert_true(scene_paint_is_there(s));
	frame_free(made_frame(s, inked, &c));
	g_assert_false(scene_paint_is_there(s));
	g_autoptr(frame) again = made_frame(s, painted, &c);
	struct picture_buffer second = made_picture(again);
	made_assert_same(&first, &second);
	picture_buffer_clear(&first);
	picture_buffer_clear(&second);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/paint/covers", test_covers);
	g_test_add_func("/paint/gaps", test_gaps);
	g_test_add_func("/paint/ways", test_ways);
	g_test_add_func("/paint/sizes", test_sizes);
	g_test_add_func("/paint/detail", test_detail);
	g_test_add_func("/paint/extents", test_extents);
	g_test_add_func("/paint/rises", test_rises);
	g_test_add_func("/paint/hides", test_hides);
	g_test_add_func("/paint/lanes", test_lanes);
	g_test_add_func("/paint/order", test_order);
	g_test_add_func("/paint/forgets", test_forgets);
	return g_test_run();
}
