#include "process/model-coarse.h"
#include "firmware-io/crc32c.h"
#include "firmware-io/files.h"
#include <glib/gstdio.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define ORDER_BITS 6
_Static_assert(1 << ORDER_BITS == MODEL_GROUP_CHUNKS, "a group's chunks in turn");

struct model_coarse {
	char *path;
	FILE *waiting; /* the first points of each chunk */
	uint64_t chunks, points;
	struct model_tones *tones;
};

static bool failed(const model_coarse *m, GError **error)
{
	return files_fail(error, m->path, "write");
}

static FILE *open_nameless(const char *path, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(path);
	g_autofree char *name = g_build_filename(folder, ".points.coarse.XXXXXX", NULL);
	int fd = g_mkstemp(name);
	if (fd < 0 || g_unlink(name) != 0)
		return files_fail(error, path, "write"), NULL;
	return fdopen(fd, "w+b");
}

model_coarse *model_coarse_new(const char *path, GError **error)
{
	FILE *waiting = open_nameless(path, error);
	if (!waiting)
		return NULL;
	model_coarse *m = g_new0(model_coarse, 1);
	m->path = g_strdup(path);
	m->waiting = waiting;
	m->tones = g_new0(struct model_tones, 1);
	return m;
}

void model_coarse_free(model_coarse *m)
{
	if (!m)
		return;
	fclose(m->waiting);
	g_free(m->tones);
	g_free(m->path);
	g_free(m);
}

/* ---- what comes ---- */

static void count_tones(model_coarse *m, const struct model_point *point, uint32_t count)
{
	struct model_tones *t = m->tones;
	uint32_t first =
		(MODEL_TONES_STEP - (uint32_t)(m->points % MODEL_TONES_STEP)) % MODEL_TONES_STEP;
	for (uint32_t i = first; i < count; i += MODEL_TONES_STEP)
		if (point[i].rgba[3])
			t->lightness[model_lightness(point[i].rgba)]++;
		else
			t->intensity[point[i].intensity]++;
	for (uint32_t i = 0; i < MIN(count, MODEL_TONES_SAMPLE); i++)
		if (!point[i].rgba[3])
			t->sample[point[i].intensity]++;
}

static uint32_t coarse_of(const struct model_chunk *c)
{
	return model_gives(c->points, MODEL_COARSE_ONE_IN);
}

bool model_coarse_add(model_coarse *m, const struct model_chunk *c, const struct model_point *point,
	GError **error)
{
	count_tones(m, point, c->points);
	m->chunks++;
	m->points += c->points;
	return fwrite(point, sizeof *point, coarse_of(c), m->waiting) == coarse_of(c) ||
	       failed(m, error);
}

/* ---- groups ---- */

static struct model_chunk group_of(
	const struct model_chunk *chunk, uint64_t first, uint32_t count, uint64_t points_before)
{
	struct model_chunk g = {
		.first = points_before, .leaf = chunk->leaf, .reserved = { (uint32_t)first, count }
	};
	for (int k = 0; k < 3; k++) {
		double low = INFINITY, high = -INFINITY;
		for (uint32_t n = 0; n < count; n++) {
			low = fmin(low, chunk[n].centre_m[k] - chunk[n].half_size_m[k]);
			high = fmax(high, chunk[n].centre_m[k] + chunk[n].half_size_m[k]);
		}
		g.centre_m[k] = (low + high) / 2;
		g.half_size_m[k] = nextafterf((float)((high - low) / 2), INFINITY);
	}
	for (uint32_t n = 0; n < count; n++)
		g.points += coarse_of(&chunk[n]);
	return g;
}

static struct model_point moved(
	struct model_point p, const struct model_chunk *from, const struct model_chunk *to)
{
	for (int k = 0; k < 3; k++)
		p.position_m[k] =
			(float)(from->centre_m[k] + (double)p.position_m[k] - to->centre_m[k]);
	return p;
}

/* As far apart as they can be at each time. */
static uint32_t place_of(uint32_t turn)
{
	uint32_t place = 0;
	for (uint32_t bit = 0; bit < ORDER_BITS; bit++)
		place |= (turn >> bit & 1) << (ORDER_BITS - 1 - bit);
	return place;
}

uint32_t model_turns(const uint32_t *gives, uint32_t members, struct model_turn *ret)
{
	uint32_t most = 0, count = 0;
	for (uint32_t n = 0; n < members; n++)
		most = MAX(most, gives[n]);
	for (uint32_t round = 0; round < most; round++)
		for (uint32_t turn = 0; turn < MODEL_GROUP_CHUNKS; turn++) {
			uint32_t n = place_of(turn);
			if (n >= members)
				continue;
			for (uint32_t i = round * gives[n] / most;
				i < (round + 1) * gives[n] / most; i++)
				ret[count++] = (struct model_turn){ (uint16_t)n, (uint16_t)i };
		}
	return count;
}

/* from: the points of each chunk, one chunk behind the other. */
static void take_turns(const struct model_chunk *chunk, const struct model_chunk *g,
	const struct model_point *from, struct model_point *to)
{
	uint32_t gives[MODEL_GROUP_CHUNKS], begin[MODEL_GROUP_CHUNKS], at = 0;
	struct model_turn turn[MODEL_CHUNK_POINTS];
	for (uint32_t n = 0; n < g->reserved[1]; n++) {
		begin[n] = at;
		at += gives[n] = coarse_of(&chunk[n]);
	}
	uint32_t count = model_turns(gives, g->reserved[1], turn);
	for (uint32_t i = 0; i < count; i++) {
		uint32_t n = turn[i].member;
		to[i] = moved(from[begin[n] + turn[i].place], &chunk[n], g);
	}
}

static bool write_group(model_coarse *m, product_writer *file, const struct model_chunk *chunk,
	struct model_chunk *g, GError **error)
{
	struct model_point from[MODEL_CHUNK_POINTS], to[MODEL_CHUNK_POINTS];
	if (fread(from, sizeof *from, g->points, m->waiting) != g->points)
		return failed(m, error);
	take_turns(chunk, g, from, to);
	g->crc32c = crc32c(0, to, g->points * sizeof *to);
	return product_writer_append(file, to, g->points, error);
}

static uint32_t chunks_of_group(const struct model_chunk *chunk, uint64_t left)
{
	uint32_t n = 1;
	while (n < MIN(left, MODEL_GROUP_CHUNKS) && chunk[n].leaf == chunk->leaf)
		n++;
	return n;
}

bool model_coarse_write(
	model_coarse *m, product_writer *file, const struct model_chunk *chunk, GError **error)
{
	g_autoptr(GArray) groups = g_array_new(FALSE, FALSE, sizeof(struct model_chunk));
	uint64_t points = 0;
	if (fflush(m->waiting) || fseek(m->waiting, 0, SEEK_SET))
		return failed(m, error);
	if (!product_writer_begin(file, "coarse", sizeof(struct model_point), error))
		return false;
	for (uint64_t n = 0; n < m->chunks;) {
		uint32_t count = chunks_of_group(chunk + n, m->chunks - n);
		struct model_chunk g = group_of(chunk + n, n, count, points);
		if (!write_group(m, file, chunk + n, &g, error))
			return false;
		g_array_append_val(groups, g);
		points += g.points;
		n += count;
	}
	return product_writer_begin(file, "groups", sizeof(struct model_chunk), error) &&
	       product_writer_append(file, groups->data, groups->len, error) &&
	       product_writer_begin(file, "tones", sizeof(uint32_t), error) &&
	       product_writer_append(file, m->tones, sizeof *m->tones / sizeof(uint32_t), error);
}
