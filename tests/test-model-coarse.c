/* What a model tells in short of all its points. */
#include "process/model-coarse.h"
#include "tests/scene-made.h"

static uint32_t coarse_of(const struct model_chunk *c)
{
	return (c->points + 63) / 64;
}

/* The place of a point, which no two have here. */
static gint64 key_of(const struct model_chunk *c, const struct model_point *p)
{
	gint64 key = 0;
	for (int k = 0; k < 3; k++)
		key = key * 1000003 + llround((c->centre_m[k] + (double)p->position_m[k]) * 2e3);
	return key;
}

static made many_chunks(void)
{
	made m = made_new();
	struct made_plane p = {
		.a_m = { 8, 0, 0 }, .b_m = { 0, 8, 0 }, .apart_m = 0.01, .rgba = { 90, 80, 70, 255 }
	};
	made_add_plane(&m, &p);
	p.leaf = MADE_LEAF + 1;
	p.corner_m[2] = p.a_m[2] = 3;
	p.b_m[1] = 2;
	memset(p.rgba, 0, 4);
	made_add_plane(&m, &p);
	made_find_folder(&m);
	made_write_to(&m, m.path);
	m.model = model_open_file(m.path, NULL);
	g_assert_nonnull(m.model);
	return m;
}

/* All chunks are in one, of their own leaf, each with its first points. */
static void test_groups(void)
{
	g_auto(made) m = many_chunks();
	uint64_t chunks, chunk = 0, all = 0;
	const struct model_chunk *c = model_chunks(m.model, &chunks);
	struct model_short s = model_in_short(m.model);
	g_assert_cmpuint(s.groups, >, 3);
	g_assert_cmpuint(s.groups, <, chunks / 10);
	for (uint64_t n = 0; n < s.groups; n++) {
		const struct model_chunk *g = &s.group[n];
		g_autoptr(GHashTable) there = g_hash_table_new(g_int64_hash, g_int64_equal);
		g_autofree gint64 *key = g_new(gint64, g->points);
		uint32_t sum = 0;
		for (uint32_t i = 0; i < g->points; i++) {
			key[i] = key_of(g, &s.point[g->first + i]);
			g_hash_table_add(there, &key[i]);
			for (int k = 0; k < 3; k++)
				g_assert_cmpfloat(fabsf(s.point[g->first + i].position_m[k]), <=,
					g->half_size_m[k] + 1e-5f);
		}
		g_assert_cmpuint(g->reserved[0], ==, chunk);
		for (uint32_t k = 0; k < g->reserved[1]; k++, chunk++) {
			g_assert_cmpuint(c[chunk].leaf, ==, g->leaf);
			sum += coarse_of(&c[chunk]);
			for (uint32_t i = 0; i < coarse_of(&c[chunk]); i++) {
				gint64 one = key_of(
					&c[chunk], &model_points(m.model)[c[chunk].first + i]);
				g_assert_true(g_hash_table_contains(there, &one));
			}
		}
		g_assert_cmpuint(g->points, ==, sum);
		all += sum;
	}
	g_assert_cmpuint(chunk, ==, chunks);
	g_assert_cmpuint(all, ==, s.points);
}

static void count_quarters(
	const struct model_short *s, const struct model_chunk *g, uint32_t prefix, double ret[4])
{
	memset(ret, 0, 4 * sizeof *ret);
	for (uint32_t i = 0; i < prefix; i++) {
		const struct model_point *p = &s->point[g->first + i];
		ret[(p->position_m[0] > 0) + 2 * (p->position_m[1] > 0)] += 1.0 / prefix;
	}
}

/* Of any prefix each quarter of the group has the share that it has of all. */
static void test_prefixes(void)
{
	g_auto(made) m = many_chunks();
	struct model_short s = model_in_short(m.model);
	const struct model_chunk *g = &s.group[0];
	double all[4], part[4];
	g_assert_cmpuint(g->reserved[1], ==, 64);
	count_quarters(&s, g, g->points, all);
	for (uint32_t prefix = 64; prefix <= g->points; prefix *= 4) {
		count_quarters(&s, g, prefix, part);
		for (int k = 0; k < 4; k++)
			g_assert_cmpfloat(fabs(part[k] - all[k]), <, 0.08);
	}
}

static void test_tones(void)
{
	g_auto(made) m = many_chunks();
	const struct model_tones *t = model_in_short(m.model).tones;
	g_autofree struct model_tones *wanted = g_new0(struct model_tones, 1);
	const struct model_point *p = model_points(m.model);
	uint64_t chunks;
	const struct model_chunk *c = model_chunks(m.model, &chunks);
	for (uint64_t i = 0; i < model_count(m.model); i += 7)
		if (p[i].rgba[3])
			wanted->lightness[model_lightness(p[i].rgba)]++;
		else
			wanted->intensity[p[i].intensity]++;
	for (uint64_t n = 0; n < chunks; n++)
		for (uint32_t i = 0; i < MIN(c[n].points, 64); i++)
			if (!p[c[n].first + i].rgba[3])
				wanted->sample[p[c[n].first + i].intensity]++;
	g_assert_cmpmem(t, sizeof *t, wanted, sizeof *wanted);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/model-coarse/groups", test_groups);
	g_test_add_func("/model-coarse/prefixes", test_prefixes);
	g_test_add_func("/model-coarse/tones", test_tones);
	return g_test_run();
}
