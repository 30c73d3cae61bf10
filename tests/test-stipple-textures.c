/* The planes of stippling: keys, what is spread, what is seen and counted, the quadtree; each beside code that does it as the paper says
 * it and no faster. */
#include "render/stipple-quadtree.h"
#include "render/stipple-texture.h"
#include "tests/scene-made.h"

#define SIDE   48
#define VECTOR 8 /* points are put on planes so many at a time */

static struct stipple_plane plane_of(uint32_t passes)
{
	struct stipple_plane p = { .is_parallel = true, .scale = 10, .passes = passes };
	stipple_plane_set_size(&p, SIDE, SIDE - 7);
	p.middle[0] = p.middle[1] = 20;
	stipple_plane_set_depths(&p, 3, 9, 25.6f);
	return p;
}

/* Points by chance, one in each `apart` texels, where points may be. */
static void scatter(
	struct stipple_texture *t, const struct stipple_plane *p, int32_t apart, uint32_t seed)
{
	g_autoptr(GRand) chance = g_rand_new_with_seed(seed);
	for (int32_t n = 0; n < p->columns * p->rows / apart; n++) {
		int32_t x = g_rand_int_range(
				chance, STIPPLE_RINGS_MOST, p->columns - STIPPLE_RINGS_MOST),
			y = g_rand_int_range(
				chance, STIPPLE_RINGS_MOST, p->rows - STIPPLE_RINGS_MOST);
		stipple_lower(&t->key[y * t->pitch + x],
			g_rand_int_range(chance, 0, (STIPPLE_DEPTH_MOST + 1) << STIPPLE_TIE_BITS));
	}
}

/* ---- the hidden-points texture ---- */

/* Section 2.1: each texel into its eight neighbours, deeper, where they are deeper still. The outer edge stays empty. */
static int32_t *spread_plainly(const int32_t *from, const struct stipple_plane *p)
{
	int32_t *to = g_memdup2(from, (size_t)(p->pitch * p->rows) * sizeof *from);
	for (int32_t y = 1; y < p->rows - 1; y++)
		for (int32_t x = 1; x < p->columns - 1; x++)
			for (int n = 0; n < 9; n++) {
				int32_t near = from[(y + n / 3 - 1) * p->pitch + x + n % 3 - 1];
				int32_t *at = &to[y * p->pitch + x];
				if (n != 4 && near + p->step < *at)
					*at = near + p->step;
			}
	return to;
}

static void test_spread(void)
{
	for (uint32_t passes = 0; passes <= 4; passes++)
		for (enum lanes_path path = 0; path <= lanes_path_widest(); path++) {
			struct stipple_texture t = { 0 };
			struct stipple_plane p = plane_of(passes);
			stipple_texture_begin(&t, &p, false);
			scatter(&t, &p, 13, passes);
			int32_t *plain =
				g_memdup2(t.key, (size_t)(p.pitch * p.rows) * sizeof *t.key);
			for (uint32_t n = 0; n < passes; n++) {
				int32_t *next = spread_plainly(plain, &p);
				g_free(plain);
				plain = next;
			}
			stipple_texture_spread(&t, &p, path, false);
			for (int32_t y = 0; y < p.rows; y++)
				g_assert_cmpmem(t.key + y * t.pitch,
					(size_t)p.columns * sizeof *plain, plain + y * p.pitch,
					(size_t)p.columns * sizeof *plain);
			g_free(plain);
			stipple_texture_clear(&t);
		}
}

/* Figure 10: A is less deep than what is beside it, D is the deepest of all. */
static void test_seen(void)
{
	struct stipple_texture t = { 0 };
	struct stipple_plane p = plane_of(1);
	stipple_texture_begin(&t, &p, true);
	int32_t a = 10 * t.pitch + 10, d = 20 * t.pitch + 20;
	for (int n = 0; n < 9; n++) {
		t.key[a + (n / 3 - 1) * t.pitch + n % 3 - 1] = n == 4 ? 2 : 4 + n % 2;
		t.key[d + (n / 3 - 1) * t.pitch + n % 3 - 1] = 3 + n % 4;
	}
	g_assert_true(stipple_is_seen(&t, a, 2));
	g_assert_false(stipple_is_seen(&t, d, 7));
	g_assert_false(stipple_is_seen(&t, d, 6)); /* as deep is not deeper */
	g_assert_true(stipple_is_seen(&t, d, 5));
	t.key[d + 1] = STIPPLE_EMPTY;
	g_assert_true(stipple_is_seen(&t, d, 7));
	stipple_texture_clear(&t);
}

/* Alone a point has all 9, or 25; a nearer one beside it takes some. */
static void test_count(void)
{
	for (uint32_t passes = 1; passes <= 3; passes++) {
		struct stipple_texture t = { 0 };
		struct stipple_plane p = plane_of(passes);
		int32_t far = 1000 << STIPPLE_TIE_BITS, near = 990 << STIPPLE_TIE_BITS;
		stipple_texture_begin(&t, &p, true);
		int32_t alone = 12 * t.pitch + 12, left = 30 * t.pitch + 30, right = left + 1;
		t.key[alone] = t.key[left] = far;
		t.key[right] = near;
		stipple_texture_spread(&t, &p, LANES_PORTABLE, true);
		g_assert_cmpuint(stipple_around(&p), ==, passes == 1 ? 9 : 25);
		g_assert_cmpuint(stipple_count(&t, &p, alone, far), ==, stipple_around(&p));
		uint32_t own = stipple_count(&t, &p, left, far),
			 other = stipple_count(&t, &p, right, near);
		/* The column of its own and those away from the nearer one. */
		g_assert_cmpuint(own, ==, passes == 1 ? 4 : 1 + 3 + 5);
		g_assert_cmpuint(other, ==, passes == 1 ? 8 : 25 - 1 - 3);
		stipple_texture_clear(&t);
	}
}

/* ---- the quadtree ---- */

static int32_t least_below(
	const int32_t *level_n, uint32_t levels, uint32_t level, uint32_t x, uint32_t y)
{
	uint32_t side = 1u << (levels - level);
	int32_t least = STIPPLE_EMPTY;
	for (uint32_t row = 0; row < side; row++)
		for (uint32_t column = 0; column < side; column++)
			least = MIN(
				least, level_n[((y * side + row) << levels) + x * side + column]);
	return least;
}

/* Formula (2), as it stands there. */
static void place_plainly(uint32_t n, uint32_t l, uint32_t x, uint32_t y, uint32_t ret[2])
{
	ret[0] = x >> (n - l);
	ret[1] = y >> (n - l);
	for (uint32_t k = l + 1; k <= n; k++)
		ret[0] += 1u << k;
}

static void test_quadtree(void)
{
	enum { LEVELS = 7, TEXELS = 1 << LEVELS };
	struct stipple_quadtree q = { 0 };
	g_autofree int32_t *level_n = g_new(int32_t, TEXELS * TEXELS);
	g_autoptr(GRand) chance = g_rand_new_with_seed(3);
	stipple_quadtree_begin(&q, LEVELS, false);
	for (uint32_t n = 0; n < TEXELS * TEXELS; n++) {
		bool is_empty = g_rand_int_range(chance, 0, 3) == 0;
		level_n[n] = is_empty ? STIPPLE_EMPTY : g_rand_int_range(chance, 0, 1 << 29);
		stipple_lower(
			&q.key[stipple_quadtree_place(LEVELS, LEVELS, n % TEXELS, n / TEXELS)],
			level_n[n]);
	}
	stipple_quadtree_fill(&q, false);
	for (uint32_t level = 0; level <= LEVELS; level++)
		for (uint32_t n = 0; n < TEXELS * TEXELS; n++) {
			uint32_t at[2], x = n % TEXELS, y = n / TEXELS;
			place_plainly(LEVELS, level, x, y, at);
			size_t place = stipple_quadtree_place(LEVELS, level, x, y);
			g_assert_cmpuint(place, ==, at[1] * 2 * TEXELS + at[0]);
			g_assert_cmpint(q.key[place], ==,
				least_below(level_n, LEVELS, level, x >> (LEVELS - level),
					y >> (LEVELS - level)));
		}
	stipple_quadtree_clear(&q);
}

/* ---- points on a plane ---- */

/* Each at the texel that its place is in, and deeper ones with greater keys; the same from all vectors. */
static void check_points(const scene *s, const struct chunk_view *v, const struct stipple_plane *p,
	enum lanes_path path)
{
	uint32_t count = v->chunk->count, room = count + VECTOR;
	g_autofree int32_t *place = g_new(int32_t, room), *key = g_new(int32_t, room);
	LANES_OF(path, stipple_project)(p, s, v, count, place, key);
	double most_m = 9. / STIPPLE_DEPTH_MOST * 4;
	for (uint32_t i = 0; i < count; i++) {
		double at[3];
		scene_position(s, v->chunk, i, at);
		/* Looking along y, x is right and z is up. */
		double x = p->middle[0] + at[0] * (double)p->scale,
		       y = p->middle[1] - at[2] * (double)p->scale;
		g_assert_cmpint(key[i], >=, 0);
		g_assert_cmpint(key[i], <, (STIPPLE_DEPTH_MOST + 1) << STIPPLE_TIE_BITS);
		if (x < 2.01 || y < 2.01 || x > p->columns - 2.01 || y > p->rows - 2.01)
			continue;
		g_assert_cmpfloat(fabs(place[i] % p->pitch + 0.5 - x), <, 0.51);
		g_assert_cmpfloat(fabs(place[i] / p->pitch + 0.5 - y), <, 0.51);
		double other[3];
		uint32_t k = (i * 7 + 3) % count;
		scene_position(s, v->chunk, k, other);
		if (other[1] > at[1] + most_m)
			g_assert_cmpint(key[k], >, key[i]);
	}
}

static void test_project(void)
{
	g_auto(made) m = made_new();
	struct made_plane plane = { .corner_m = { -2.5, 4, -2 },
		.a_m = { 5, 2, 0 },
		.b_m = { 0, 1, 4 },
		.apart_m = 0.06,
		.order = MADE_RANDOM,
		.no_normal = true };
	made_add_plane(&m, &plane);
	const scene *s = made_read(&m);
	struct camera c =
		camera_look_at((double[3]){ 0, 0, 0 }, (double[3]){ 0, 1, 0 }, 60, 100, 100);
	struct stipple_plane p = plane_of(1);
	stipple_plane_set_depths(&p, 3.5f, 9, 25.6f);
	for (uint32_t n = 0; n < s->chunks; n++) {
		struct chunk_view v;
		stipple_plane_view(&c, s, &s->chunk[n], &v);
		g_assert_cmpfloat(v.near_m, <, v.far_m);
		for (enum lanes_path path = 0; path <= lanes_path_widest(); path++)
			check_points(s, &v, &p, path);
	}
}

/* A pass goes as deep as so many texels are wide, within the steps of a float's bits. */
static void test_step(void)
{
	struct stipple_plane p = { .scale = 1000 };
	stipple_plane_set_depths(&p, 1, 100, 20);
	for (float depth_m = 1; depth_m < 50; depth_m *= 1.3f) {
		union {
			float depth_m;
			int32_t bits;
		} before = { depth_m }, after;
		after.bits = before.bits + (p.step >> STIPPLE_TIE_BITS << p.shift);
		float texels = (after.depth_m - depth_m) / (depth_m / p.scale);
		g_assert_cmpfloat(texels, >, 20 * 0.69f);
		g_assert_cmpfloat(texels, <, 20 * 1.42f);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/stipple-textures/spread", test_spread);
	g_test_add_func("/stipple-textures/seen", test_seen);
	g_test_add_func("/stipple-textures/count", test_count);
	g_test_add_func("/stipple-textures/quadtree", test_quadtree);
	g_test_add_func("/stipple-textures/project", test_project);
	g_test_add_func("/stipple-textures/step", test_step);
	return g_test_run();
}
