/* The visibility mask against one that is drawn point by point and pixel by pixel in doubles; and what it is for: surfaces without
 * holes, which do not hide themselves, and hide what is behind. */
#include "render/mask.h"
#include "render/splat.h"
#include "tests/scene-made.h"
#include <omp.h>

/* As disc-lanes.h has them. */
#define DISC_CROWD        5.
#define DISC_RADIUS_LEAST 0.72
#define DISC_RADIUS_MOST  48.
#define DISC_STEEPEST     40.

#define POINTS_ONLY MADE_SITE("{\"step\":\"points\"}")

static visibility_mask *mask_of(const frame *f)
{
	uint32_t count;
	g_autofree struct chunk_view *views = chunk_views_new(f, &count);
	return visibility_mask_new(f, views, count);
}

static bool is_empty(const visibility_mask *m, uint32_t x, uint32_t y)
{
	return mask_key(m, (int32_t)x, (int32_t)y) >= MASK_EMPTY;
}

/* ---- the reference ---- */

struct reference {
	const frame *f;
	double *depth_m; /* INFINITY: nothing */
	double turn[3][3];
};

static double dot3(const double a[3], const double b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

struct big_disc {
	double px[2], radius, squash[2], tilt[2], depth_m;
};

/* How flat it is seen, and how steep its depth is there: disc-lanes.h. */
static void tilt(const struct reference *r, const int16_t packed[2], struct big_disc *d)
{
	const struct camera *c = &r->f->camera;
	float of_site[3];
	double n[3], ray[3] = { (d->px[0] - c->width / 2.) / c->focal_px,
		(d->px[1] - c->height / 2.) / c->focal_px, 1 };
	model_unpack_normal(packed, of_site);
	for (int k = 0; k < 3; k++)
		n[k] = r->turn[k][0] * (double)of_site[0] + r->turn[k][1] * (double)of_site[1] +
		       r->turn[k][2] * (double)of_site[2];
	double along = dot3(n, ray), aside2 = n[0] * n[0] + n[1] * n[1];
	if (!(aside2 > 1e-6))
		return;
	double flat = DISC_RADIUS_LEAST / d->radius;
	double cosine2 = CLAMP(fmax(along * along / dot3(ray, ray), flat * flat), 1e-3, 1);
	double squash = sqrt((1 / cosine2 - 1) / aside2);
	double slope = d->depth_m /
		       fmax(fabs(along) * c->focal_px,
			       sqrt(aside2) * fmax(d->radius * 3, c->focal_px / DISC_STEEPEST));
	for (int k = 0; k < 2; k++) {
		d->squash[k] = squash * n[k];
		d->tilt[k] = (along >= 0 ? -slope : slope) * n[k];
	}
}

static void fill_dot(const struct reference *r, const struct big_disc *d, double pushed_m)
{
	const struct camera *c = &r->f->camera;
	double x = floor(d->px[0]), y = floor(d->px[1]);
	if (x < 0 || y < 0 || x >= c->width || y >= c->height)
		return;
	double *at = &r->depth_m[(size_t)y * c->width + (size_t)x];
	*at = fmin(*at,
		pushed_m + d->tilt[0] * (x + 0.5 - d->px[0]) + d->tilt[1] * (y + 0.5 - d->px[1]));
}

static void fill_disc(const struct reference *r, const struct big_disc *d, double pushed_m)
{
	const struct camera *c = &r->f->camera;
	if (d->radius < MASK_DOT_RADIUS) {
		fill_dot(r, d, pushed_m);
		return;
	}
	int left = (int)fmax(floor(d->px[0] - d->radius), 0),
	    right = (int)fmin(d->px[0] + d->radius + 1, c->width - 1.),
	    top = (int)fmax(floor(d->px[1] - d->radius), 0),
	    bottom = (int)fmin(d->px[1] + d->radius + 1, c->height - 1.);
	for (int y = top; y <= bottom; y++)
		for (int x = left; x <= right; x++) {
			double dx = x + 0.5 - d->px[0], dy = y + 0.5 - d->px[1];
			double across = d->squash[0] * dx + d->squash[1] * dy;
			double *at = &r->depth_m[(size_t)y * c->width + (size_t)x];
			if (dx * dx + dy * dy + across * across <= d->radius * d->radius)
				*at = fmin(*at, pushed_m + d->tilt[0] * dx + d->tilt[1] * dy);
		}
}

static void fill_point(const struct reference *r, const struct scene_chunk *chunk, uint32_t i)
{
	const scene *s = r->f->scene;
	const struct camera *c = &r->f->camera;
	const struct mask_step *step = &g_array_index(
		r->f->drawing->pipelines, struct pipeline, r->f->drawing->pipeline_of[chunk->leaf])
						.mask;
	struct big_disc d = { { 0 } };
	double at[3];
	scene_position(s, chunk, i, at);
	if (!camera_project(c, at, d.px, &d.depth_m))
		return;
	double scale = 1e-4 * c->focal_px / d.depth_m;
	double spacing_px = s->place[chunk->first + i].spacing * scale,
	       disc_px = s->disc[chunk->first + i] * scale;
	double part = fmin(spacing_px * spacing_px * DISC_CROWD, 1);
	if ((i + 0.5) / chunk->count >= part)
		return;
	d.radius = CLAMP(0.5 * (double)step->disc * disc_px / sqrt(part), DISC_RADIUS_LEAST,
		DISC_RADIUS_MOST * fmax(c->height / FRAME_STYLE_HEIGHT, 1));
	tilt(r, s->normal[chunk->first + i], &d);
	double pushed_m = d.depth_m * (1 + (double)step->offset_relative) + (double)step->offset_m +
			  d.radius * d.depth_m / c->focal_px;
	fill_disc(r, &d, pushed_m);
}

static double depth_at(const struct reference *r, int x, int y)
{
	const struct camera *c = &r->f->camera;
	if (x < 0 || y < 0 || x >= (int)c->width || y >= (int)c->height)
		return INFINITY;
	return r->depth_m[(size_t)y * c->width + (size_t)x];
}

/* Between two that are nearer, one or two pixels apart. */
static double without_holes(const struct reference *r, int x, int y)
{
	static const int ways[4][2] = { { 1, 0 }, { 0, 1 }, { 1, 1 }, { 1, -1 } };
	double own = depth_at(r, x, y), between = INFINITY;
	for (int n = 0; n < 4; n++)
		for (int before = 1; before <= 2; before++)
			for (int after = 1; before + after <= (n < 2 ? 3 : 2); after++)
				between = fmin(between, fmax(depth_at(r, x - before * ways[n][0],
								     y - before * ways[n][1]),
								depth_at(r, x + after * ways[n][0],
									y + after * ways[n][1])));
	return between * MASK_HOLE < own ? between : own;
}

static double *filled(const struct reference *r)
{
	const struct camera *c = &r->f->camera;
	double *to = g_new(double, (size_t)c->width * c->height);
	for (uint32_t y = 0; y < c->height; y++)
		for (uint32_t x = 0; x < c->width; x++)
			to[(size_t)y * c->width + x] = without_holes(r, (int)x, (int)y);
	return to;
}

/* Caller frees. */
static double *reference_of(const frame *f)
{
	struct reference r = { .f = f };
	size_t pixels = (size_t)f->camera.width * f->camera.height;
	r.depth_m = g_new(double, pixels);
	memcpy(r.turn[0], f->camera.right, sizeof r.turn[0]);
	memcpy(r.turn[1], f->camera.down, sizeof r.turn[1]);
	memcpy(r.turn[2], f->camera.forward, sizeof r.turn[2]);
	for (size_t i = 0; i < pixels; i++)
		r.depth_m[i] = INFINITY;
	for (uint32_t n = 0; n < f->scene->chunks; n++)
		for (uint32_t i = 0; i < f->scene->chunk[n].count; i++)
			fill_point(&r, &f->scene->chunk[n], i);
	double *whole = filled(&r);
	g_free(r.depth_m);
	return whole;
}

/* Pixels where it is another one: at the borders of discs floats decide as they like. */
static void assert_as_reference(const frame *f, double pixels_allowed)
{
	g_autoptr(visibility_mask) m = mask_of(f);
	g_autofree double *depth_m = reference_of(f);
	size_t differ = 0, covered = 0;
	for (uint32_t y = 0; y < m->height; y++)
		for (uint32_t x = 0; x < m->width; x++) {
			double wanted = depth_m[(size_t)y * m->width + x],
			       depth = (double)mask_depth(mask_key(m, (int32_t)x, (int32_t)y));
			covered += isfinite(wanted);
			if (is_empty(m, x, y) || !isfinite(wanted))
				differ += is_empty(m, x, y) != !isfinite(wanted);
			else
				differ += !(fabs(depth - wanted) <= 1e-4 * wanted);
		}
	double allowed = fmax(1e-3 * m->width * m->height, pixels_allowed);
	g_test_message("%ux%u: %zu of %zu covered differ", m->width, m->height, differ, covered);
	g_assert_cmpfloat((double)differ, <=, allowed);
}

/* ---- a scene from all sides ---- */

static const struct look {
	double eye[3], target[3], fov_deg;
	uint32_t width, height;
} looks[] = {
	{ { 103, 194, 5 }, { 103, 205, 4 }, 60, 320, 240 },
	{ { 103, 203, 3.2 }, { 101, 203.4, 3.6 }, 90, 320,
		240 },                                          /* in the midst, near the ground */
	{ { 102, 203, 4.2 }, { 103, 205, 4.5 }, 60, 160, 120 }, /* among the leaves */
	{ { 103, 120, 40 }, { 103, 203, 4 }, 20, 320, 240 },    /* far: fewer points */
	{ { 103, 203.001, 60 }, { 103, 203, 3 }, 10, 200, 300 },
	{ { 103, 208, 4 }, { 103, 220, 4 }, 60, 64, 48 }, /* with all of it behind */
	{ { 99, 199, 3.3 }, { 106, 206, 3.4 }, 170, 320, 240 },
	{ { 103, 194, 5 }, { 103, 205, 4 }, 60, 1, 1 },
	{ { 103, 194, 5 }, { 103, 205, 4 }, 60, 3, 2000 },
	{ { 103, 194, 5 }, { 103, 205, 4 }, 60, 2000, 3 },
	{ { 103, 194, 5 }, { 103, 205, 4 }, 60, 17, 9 },
	{ { 103, 204.4, 4 }, { 103, 205, 4 }, 60, 200,
		3600 }, /* discs wider than those of small pictures */
};

static frame *look_at_court(const struct look *l, drawing **ret_drawing)
{
	struct camera c = camera_look_at(l->eye, l->target, l->fov_deg, l->width, l->height);
	*ret_drawing = made_drawing(POINTS_ONLY ",\"Tree\":{\"steps\":[{\"step\":\"sprites\"}]}");
	return made_frame(made_shared_court(), *ret_drawing, &c);
}

static void test_reference(gconstpointer data)
{
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f = look_at_court(data, &d);
	assert_as_reference(f, 2);
	f->lanes = LANES_PORTABLE;
	assert_as_reference(f, 2);
}

static void assert_same(const visibility_mask *a, const visibility_mask *b)
{
	for (uint32_t y = 0; y < a->height; y++)
		g_assert_cmpmem(a->key + (size_t)y * a->pitch, 4 * a->width,
			b->key + (size_t)y * b->pitch, 4 * b->width);
}

/* The same bytes with whatever vectors, on any number of threads. */
static void test_bytes(gconstpointer data)
{
	static const int threads[] = { 1, 2, 5 };
	int before = omp_get_max_threads();
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f = look_at_court(data, &d);
	g_autoptr(visibility_mask) m = mask_of(f);
	for (size_t i = 0; i < G_N_ELEMENTS(threads); i++) {
		omp_set_num_threads(threads[i]);
		g_autoptr(visibility_mask) other = mask_of(f);
		assert_same(m, other);
	}
	omp_set_num_threads(before);
	for (enum lanes_path path = 0; path < lanes_path_widest(); path++) {
		f->lanes = path;
		g_autoptr(visibility_mask) other = mask_of(f);
		assert_same(m, other);
	}
	f->single_thread = true;
	g_autoptr(visibility_mask) single = mask_of(f);
	assert_same(m, single);
}

/* The nearest has the pixel, and says which pipeline it is of. */
static void test_pipelines(void)
{
	g_autoptr(drawing) d = NULL;
	g_autoptr(frame) f = look_at_court(&looks[0], &d);
	g_autoptr(visibility_mask) m = mask_of(f);
	size_t pixels[2] = { 0 };
	int tree = d->pipeline_of[MADE_LEAF + 1], yard = d->pipeline_of[MADE_LEAF];
	g_assert_cmpint(tree, !=, yard);
	for (uint32_t y = 0; y < m->height; y++)
		for (uint32_t x = 0; x < m->width; x++) {
			int32_t key = mask_key(m, (int32_t)x, (int32_t)y);
			float depth_m = mask_depth(key);
			if (key >= MASK_EMPTY)
				continue;
			g_assert_true((key & 255) == tree || (key & 255) == yard);
			pixels[(key & 255) == tree]++;
			/* The ball is 8.4 to 9.6 m away along the axis, the wall is not. */
			if ((key & 255) == tree)
				g_assert_true(depth_m > 8.2f && depth_m < 10.f);
		}
	g_assert_cmpuint(pixels[0], >, 7000);
	g_assert_cmpuint(pixels[1], >, 300);
}

/* ---- planes ---- */

enum { SIDE = 400 }; /* points */

/* Of points that stand 10 mm apart, in the xz plane around the origin. */
static made plane_made(enum made_order order, double behind_m)
{
	made m = made_new();
	double half = SIDE * 0.01 / 2;
	struct made_plane p = { .corner_m = { -half, 0, -half },
		.a_m = { 2 * half, 0, 0 },
		.b_m = { 0, 0, 2 * half },
		.apart_m = 0.01,
		.order = order };
	made_add_plane(&m, &p);
	if (behind_m > 0) {
		p.corner_m[1] = behind_m;
		p.leaf = MADE_LEAF + 1;
		made_add_plane(&m, &p);
	}
	made_read(&m);
	return m;
}

/* Points of the plane's middle are apart_px from each other across the slant. */
static struct camera slanted(double slant_deg, double apart_px, uint32_t width, uint32_t height)
{
	static const double origin[3] = { 0, 0, 0 };
	double fov_deg = 40, focal_px = height / 2. / tan(fov_deg / 2 * G_PI / 180);
	double away_m = 0.01 * focal_px / apart_px, a = slant_deg * G_PI / 180;
	double eye[3] = { -away_m * sin(a) * 0.8, -away_m * cos(a), away_m * sin(a) * 0.6 };
	return camera_look_at(eye, origin, fov_deg, width, height);
}

/* Depth where the ray through a place meets the plane y = at_m; 0: it does not, or near its border. */
static double depth_of_plane(const struct camera *c, double at_m, double px, double py)
{
	double ray[3], scale, place[2] = { px, py }, half = SIDE * 0.01 / 2 - 0.1;
	camera_ray(c, place, ray);
	scale = (at_m - c->eye_m[1]) / ray[1];
	if (!(scale > 0))
		return 0;
	double x = c->eye_m[0] + scale * ray[0], z = c->eye_m[2] + scale * ray[2];
	if (fabs(x) > half || fabs(z) > half)
		return 0;
	double depth = scale * dot3(ray, c->forward);
	return depth >= c->near_m ? depth : 0;
}

static void count_holes(const frame *f, size_t *holes, size_t *covered)
{
	g_autoptr(visibility_mask) m = mask_of(f);
	for (uint32_t y = 0; y < m->height; y++)
		for (uint32_t x = 0; x < m->width; x++) {
			if (!depth_of_plane(&f->camera, 0, x + 0.5, y + 0.5))
				continue;
			++*covered;
			*holes += is_empty(m, x, y);
		}
}

static const double slants_deg[] = { 0, 20, 40, 60, 80, 85 };
static const double aparts_px[] = { 6, 1.2, 0.8, 0.58, 0.2 };

/* Holes to a covered pixel. */
static const struct closed {
	const char *name;
	enum made_order order;
	const char *disc;
	double apart_allowed, crowded_allowed; /* from 0.8 pixels on and below */
} closed[] = {
	{ "regular", MADE_REGULAR, "1.5", 1e-4, 1e-4 },
	/* One point in each square, anywhere: discs of 1.5 leave a twentieth open, which larger ones close. */
	{ "jittered", MADE_JITTERED, "1.5", 0.07, 1e-4 },
	{ "jittered-large", MADE_JITTERED, "3", 1e-4, 1e-4 },
	/* What discs of this size leave of points that fall anywhere: exp(-area), 0.17 and 0.0009. */
	{ "random", MADE_RANDOM, "1.5", 0.2, 0.011 },
	{ "random-large", MADE_RANDOM, "3", 2e-3, 2e-3 },
};

static void assert_closed(
	const struct closed *b, double slant_deg, double apart_px, size_t holes, size_t covered)
{
	double allowed = apart_px > 0.7 ? b->apart_allowed : b->crowded_allowed;
	g_test_message(
		"%g degrees, %g px apart: %zu holes of %zu", slant_deg, apart_px, holes, covered);
	g_assert_cmpuint(covered, >, 500);
	g_assert_cmpfloat((double)holes, <=, fmax(allowed * (double)covered, 3));
}

/* Of regular points, of such that stand anywhere in their squares, and of such that stand anywhere. */
static void test_holes(gconstpointer data)
{
	const struct closed *b = data;
	g_auto(made) m = plane_made(b->order, 0);
	g_autofree char *nodes = g_strdup_printf(
		MADE_SITE("{\"step\":\"mask\",\"disc\":%s},{\"step\":\"points\"}"), b->disc);
	g_autoptr(drawing) d = made_drawing(nodes);
	for (size_t i = 0; i < G_N_ELEMENTS(aparts_px); i++)
		for (size_t k = 0; k < G_N_ELEMENTS(slants_deg); k++) {
			struct camera c = slanted(slants_deg[k], aparts_px[i], 400, 300);
			g_autoptr(frame) f = made_frame(m.scene, d, &c);
			size_t holes = 0, covered = 0;
			count_holes(f, &holes, &covered);
			assert_closed(b, slants_deg[k], aparts_px[i], holes, covered);
		}
}

/* ---- what hides and what is hidden ---- */

struct sight {
	size_t own, own_hidden, steep, steep_hidden, behind, behind_shown;
};

/* Whether the plane y = 0 is seen at up to 80 degrees there. */
static bool is_facing(const struct camera *c, const double px[2])
{
	double ray[3];
	camera_ray(c, px, ray);
	return fabs(ray[1]) >= cos(80 * G_PI / 180);
}

static void look_point(const frame *f, const visibility_mask *m, const struct scene_chunk *c,
	uint32_t i, struct sight *s)
{
	double at[3], px[2], depth_m;
	scene_position(f->scene, c, i, at);
	if (!camera_project(&f->camera, at, px, &depth_m) || px[0] < 0 || px[1] < 0 ||
		px[0] >= m->width || px[1] >= m->height)
		return;
	bool shown = depth_m <= (double)mask_depth(mask_key(m, (int)px[0], (int)px[1]));
	if (c->leaf != MADE_LEAF) {
		s->behind += depth_of_plane(&f->camera, 0, px[0], px[1]) > 0;
		s->behind_shown += shown && depth_of_plane(&f->camera, 0, px[0], px[1]) > 0;
	} else if (is_facing(&f->camera, px)) {
		s->own++;
		s->own_hidden += !shown;
	} else {
		s->steep++;
		s->steep_hidden += !shown;
	}
}

static struct sight look(const frame *f)
{
	struct sight s = { 0 };
	g_autoptr(visibility_mask) m = mask_of(f);
	for (uint32_t n = 0; n < f->scene->chunks; n++)
		for (uint32_t i = 0; i < f->scene->chunk[n].count; i++)
			look_point(f, m, &f->scene->chunk[n], i, &s);
	return s;
}

static void assert_sight(double slant_deg, double apart_px, const struct sight *s)
{
	g_test_message("%g degrees, %g px apart: hidden %zu of %zu, beyond 80 degrees %zu of %zu; "
		       "behind shown %zu of %zu",
		slant_deg, apart_px, s->own_hidden, s->own, s->steep_hidden, s->steep,
		s->behind_shown, s->behind);
	g_assert_cmpuint(s->own + s->steep, >, 500);
	g_assert_cmpfloat((double)s->behind_shown, <=, 1e-3 * (double)s->behind);
	g_assert_cmpfloat((double)s->own_hidden, <=, 0.005 * (double)s->own);
	/* Beyond, a pixel is deeper than what points are pushed back by. */
	g_assert_cmpfloat((double)s->steep_hidden, <=, 0.25 * (double)s->steep);
}

static void test_hides(gconstpointer data)
{
	bool regular = data;
	g_auto(made) m = plane_made(regular ? MADE_REGULAR : MADE_JITTERED, 0.6);
	g_autoptr(drawing) d = made_drawing(
		regular ? POINTS_ONLY
			: MADE_SITE("{\"step\":\"mask\",\"disc\":3},{\"step\":\"points\"}"));
	for (size_t i = 0; i < G_N_ELEMENTS(aparts_px); i++)
		for (size_t k = 0; k < G_N_ELEMENTS(slants_deg); k++) {
			struct camera c = slanted(slants_deg[k], aparts_px[i], 400, 300);
			g_autoptr(frame) f = made_frame(m.scene, d, &c);
			struct sight s = look(f);
			assert_sight(slants_deg[k], aparts_px[i], &s);
		}
}

/* Chunks that are hidden are left out, and nothing else is another picture. */
static void test_culls(void)
{
	g_auto(made) m = plane_made(MADE_REGULAR, 0.6);
	g_autoptr(drawing) d = made_drawing(POINTS_ONLY);
	uint32_t hidden = 0;
	for (size_t n = 0; n < G_N_ELEMENTS(slants_deg); n++) {
		struct camera c = slanted(slants_deg[n], 1.2, 400, 300);
		g_autoptr(frame) f = made_frame(m.scene, d, &c);
		uint32_t count;
		g_autofree struct chunk_view *views = chunk_views_new(f, &count);
		g_autoptr(visibility_mask) culled = visibility_mask_new(f, views, count);
		for (uint32_t k = 0; k < count; k++)
			views[k].nearest_m = 0; /* nothing is behind anything */
		g_autoptr(visibility_mask) whole = visibility_mask_new(f, views, count);
		hidden += culled->chunks_hidden;
		g_assert_cmpuint(whole->chunks_hidden, ==, 0);
		for (int y = 0; y < 300; y++)
			g_assert_cmpmem(culled->key + y * (int)culled->pitch, 4 * 400,
				whole->key + y * (int)whole->pitch, 4 * 400);
	}
	g_test_message("%u chunks left out", hidden);
	g_assert_cmpuint(hidden, >, 0);
}

/* Sums of light and weights of the band; free it. */
static float *colours_of(const frame *f, const visibility_mask *m, const struct band *b,
	const struct chunk_view *views, uint32_t count)
{
	size_t plane = (size_t)b->pitch * b->rows;
	float *sums = g_new0(float, 4 * plane),
	      *light[3] = { sums, sums + plane, sums + 2 * plane };
	splat_band(b, f, m, views, count, light, sums + 3 * plane);
	return sums;
}

/* Sums are the same with what cannot show, by how it reaches or by what is before it; how many chunks that is in a band that they reach. */
static uint32_t assert_culled(const frame *f, const visibility_mask *m, const struct band *b,
	const struct chunk_view *views, uint32_t count)
{
	g_autofree struct chunk_view *all = g_memdup2(views, count * sizeof *views);
	uint32_t hidden = 0;
	for (uint32_t k = 0; k < count; k++) {
		all[k].nearest_m = 0;
		hidden += mask_may_show(m, &all[k], b->from, b->from + b->rows) &&
			  !mask_may_show(m, &views[k], b->from, b->from + b->rows);
		all[k].margin_px = 1e6f;
		g_assert_true(mask_may_show(m, &all[k], b->from, b->from + b->rows));
	}
	g_autofree float *culled = colours_of(f, m, b, views, count),
			 *whole = colours_of(f, m, b, all, count);
	/* Vectors write beyond the last column, too. */
	for (size_t at = BAND_MARGIN; at < 4 * (size_t)b->pitch * b->rows; at += b->pitch)
		g_assert_cmpmem(culled + at, 4 * b->width, whole + at, 4 * b->width);
	return hidden;
}

/* Nor are coloured points another picture, which here reach over much more than the mask's discs. */
static void test_culls_colours(void)
{
	g_auto(made) m = plane_made(MADE_REGULAR, 0.6);
	g_autoptr(drawing) d = made_drawing(MADE_SITE("{\"step\":\"points\",\"size\":12}"));
	uint32_t hidden = 0;
	for (size_t n = 0; n < G_N_ELEMENTS(looks) + G_N_ELEMENTS(slants_deg); n++) {
		const struct look *l = &looks[MIN(n, G_N_ELEMENTS(looks) - 1)];
		bool is_court = n < G_N_ELEMENTS(looks);
		struct camera c =
			is_court
				? camera_look_at(l->eye, l->target, l->fov_deg, l->width, l->height)
				: slanted(slants_deg[n - G_N_ELEMENTS(looks)], 4, 400, 300);
		g_autoptr(frame) f = made_frame(is_court ? made_shared_court() : m.scene, d, &c);
		uint32_t count;
		g_autofree struct chunk_view *views = chunk_views_new(f, &count);
		g_autoptr(visibility_mask) mask = visibility_mask_new(f, views, count);
		for (uint32_t from = 0; from < c.height; from += BAND_ROWS) {
			struct band b = { c.width, from, MIN(BAND_ROWS, c.height - from),
				(c.width + 2 * BAND_MARGIN + 7) / 8 * 8 };
			hidden += assert_culled(f, mask, &b, views, count);
		}
	}
	g_test_message("%u chunks left out", hidden);
	g_assert_cmpuint(hidden, >, 0);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(looks); i++) {
		g_autofree char *a = g_strdup_printf("/mask/reference/%zu", i),
				*b = g_strdup_printf("/mask/bytes/%zu", i);
		g_test_add_data_func(a, &looks[i], test_reference);
		g_test_add_data_func(b, &looks[i], test_bytes);
	}
	g_test_add_func("/mask/pipelines", test_pipelines);
	for (size_t i = 0; i < G_N_ELEMENTS(closed); i++) {
		g_autofree char *path = g_strconcat("/mask/holes/", closed[i].name, NULL);
		g_test_add_data_func(path, &closed[i], test_holes);
	}
	g_test_add_data_func("/mask/hides/regular", GINT_TO_POINTER(1), test_hides);
	g_test_add_data_func("/mask/hides/jittered-large", NULL, test_hides);
	g_test_add_func("/mask/culls", test_culls);
	g_test_add_func("/mask/culls/colours", test_culls_colours);
	return g_test_run();
}
