#include "process/model.h"
#include "firmware-io/crc32c.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <string.h>

struct model {
	product *file;
	const struct model_chunk *chunks;
	const struct model_point *points;
	uint64_t chunk_count, point_count;
	struct model_short in_short;
};

static bool damaged(const model *m, uint64_t chunk, const char *what, GError **error)
{
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
		"%s: chunk %" G_GUINT64_FORMAT ": %s", product_path(m->file), chunk, what);
	return false;
}

static bool check_chunk(const model *m, uint64_t which, uint64_t first, GError **error)
{
	const struct model_chunk *c = &m->chunks[which];
	if (c->first != first || c->points < 1 || c->points > MODEL_CHUNK_POINTS ||
		c->points > m->point_count - first)
		return damaged(m, which, "its points are not those after the chunk before", error);
	for (int i = 0; i < 3; i++)
		if (!isfinite(c->centre_m[i]) || !isfinite(c->half_size_m[i]) ||
			c->half_size_m[i] < 0)
			return damaged(m, which, "its box is no box", error);
	if (c->leaf > UINT16_MAX)
		return damaged(m, which, "no tree of segments has its leaf", error);
	return true;
}

static bool check_chunks(const model *m, GError **error)
{
	uint64_t first = 0;
	for (uint64_t i = 0; i < m->chunk_count; i++) {
		if (!check_chunk(m, i, first, error))
			return false;
		first += m->chunks[i].points;
	}
	if (first == m->point_count)
		return true;
	return damaged(m, m->chunk_count, "points are left over after the last chunk", error);
}

/* Groups that all chunks are in, one after another, and their points. */
static bool check_groups(const model *m, GError **error)
{
	const struct model_short *s = &m->in_short;
	uint64_t chunk = 0, first = 0;
	for (uint64_t i = 0; i < s->groups; i++) {
		const struct model_chunk *g = &s->group[i];
		if (g->reserved[0] != chunk || !g->reserved[1] ||
			g->reserved[1] > MODEL_GROUP_CHUNKS ||
			g->reserved[1] > m->chunk_count - chunk || g->first != first ||
			g->points < 1 || g->points > MODEL_CHUNK_POINTS ||
			g->points > s->points - first || g->leaf != m->chunks[chunk].leaf)
			return damaged(
				m, chunk, "its group is not the one after that before", error);
		for (int k = 0; k < 3; k++)
			if (!isfinite(g->centre_m[k]) || !(g->half_size_m[k] >= 0) ||
				!isfinite(g->half_size_m[k]))
				return damaged(m, chunk, "the box of its group is no box", error);
		chunk += g->reserved[1];
		first += g->points;
	}
	return (chunk == m->chunk_count && first == s->points) ||
	       damaged(m, chunk, "the groups are not those of all chunks", error);
}

static bool find_short(model *m, GError **error)
{
	struct model_short s = { 0 };
	uint64_t words;
	s.group = product_section(m->file, "groups", sizeof *s.group, &s.groups, NULL);
	s.point = product_section(m->file, "coarse", sizeof *s.point, &s.points, NULL);
	s.tones = product_section(m->file, "tones", sizeof(uint32_t), &words, NULL);
	if (!s.group || !s.point || !s.tones || words * sizeof(uint32_t) != sizeof *s.tones)
		return true;
	m->in_short = s;
	return check_groups(m, error);
}

static bool check_version(const model *m, GError **error)
{
	gint64 version = json_object_get_int_member(product_manifest(m->file), "version");
	if (version == MODEL_VERSION)
		return true;
	g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_VERSION,
		"%s: was written by an earlier version of this program (%s %" G_GINT64_FORMAT
		"); 'pleinair process' makes it anew",
		product_path(m->file), MODEL_KIND, version);
	return false;
}

char *model_path(const char *site_path)
{
	return g_build_filename(site_path, "model", "points.model", NULL);
}

model *model_open_file(const char *path, GError **error)
{
	g_autoptr(model) m = g_new0(model, 1);
	m->file = product_open(path, MODEL_KIND, MODEL_VERSION, error);
	if (!m->file || !check_version(m, error) ||
		!(m->chunks = product_section(
			  m->file, "chunks", sizeof *m->chunks, &m->chunk_count, error)) ||
		!(m->points = product_section(
			  m->file, "points", sizeof *m->points, &m->point_count, error)) ||
		!check_chunks(m, error) || !find_short(m, error))
		return NULL;
	return g_steal_pointer(&m);
}

model *model_open(const char *site_path, GError **error)
{
	g_autofree char *path = model_path(site_path);
	return model_open_file(path, error);
}

void model_free(model *m)
{
	if (!m)
		return;
	product_free(m->file);
	g_free(m);
}

uint64_t model_count(const model *m)
{
	return m->point_count;
}

const struct model_chunk *model_chunks(const model *m, uint64_t *ret_count)
{
	*ret_count = m->chunk_count;
	return m->chunks;
}

const struct model_point *model_points(const model *m)
{
	return m->points;
}

struct model_short model_in_short(const model *m)
{
	return m->in_short;
}

const product *model_file(const model *m)
{
	return m->file;
}

bool model_verify_chunk(const model *m, uint64_t chunk, GError **error)
{
	const struct model_chunk *c = &m->chunks[chunk];
	return crc32c(0, m->points + c->first, c->points * sizeof *m->points) == c->crc32c ||
	       damaged(m, chunk, "its points are damaged", error);
}

bool model_verify(const model *m, GError **error)
{
	for (uint64_t i = 0; i < m->chunk_count; i++) {
		if (!model_verify_chunk(m, i, error))
			return false;
		product_forget(m->file, m->points + m->chunks[i].first,
			m->chunks[i].points * sizeof *m->points);
	}
	return product_verify(m->file, error);
}

/* ---- normals ---- */

static int16_t snorm(float value)
{
	return (int16_t)lrintf(CLAMP(value, -1.0f, 1.0f) * 32767.0f);
}

/* The sphere onto an octahedron, that onto a square, its lower half folded outwards (Cigolle et al. 2014, "A Survey of Efficient
 * Representations for Independent Unit Vectors"). */
void model_pack_normal(const float normal[3], int16_t ret[2])
{
	float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
	ret[0] = ret[1] = MODEL_NORMAL_NONE;
	if (!(sum > 0) || !isfinite(sum))
		return;
	float u = normal[0] / sum, v = normal[1] / sum;
	if (normal[2] < 0) {
		float across = copysignf(1 - fabsf(v), u), up = copysignf(1 - fabsf(u), v);
		u = across;
		v = up;
	}
	ret[0] = snorm(u);
	ret[1] = snorm(v);
}

void model_unpack_normal(const int16_t packed[2], float ret[3])
{
	ret[0] = ret[1] = ret[2] = 0;
	if (packed[0] == MODEL_NORMAL_NONE && packed[1] == MODEL_NORMAL_NONE)
		return;
	float u = MAX((float)packed[0] / 32767.0f, -1), v = MAX((float)packed[1] / 32767.0f, -1);
	float z = 1 - fabsf(u) - fabsf(v), fold = MAX(-z, 0);
	float x = u - copysignf(fold, u), y = v - copysignf(fold, v);
	float length = sqrtf(x * x + y * y + z * z);
	ret[0] = x / length;
	ret[1] = y / length;
	ret[2] = z / length;
}

/* ---- half floats: sign, 5 bits of the exponent + 15, 10 of the mantissa; floats have 8, + 127, and 23 ---- */

#define HALF_MAX        65504.0f
#define HALF_NORMAL_MIN 0x1p-14f
#define EXPONENTS_APART (127 - 15)
#define MANTISSAS_APART (23 - 10)

uint16_t model_pack_half(float value)
{
	uint16_t sign = signbit(value) ? 0x8000 : 0;
	float size = fminf(fabsf(value), HALF_MAX);
	uint32_t bits;
	if (isnan(value))
		return MODEL_HALF_NONE;
	if (size < HALF_NORMAL_MIN)
		return sign | (uint16_t)lrintf(size * 0x1p24f);
	memcpy(&bits, &size, sizeof bits);
	/* Just under a half, and what makes of a half up from an odd one; a carry goes into the exponent, as it should. */
	bits += (1u << (MANTISSAS_APART - 1)) - 1 + (bits >> MANTISSAS_APART & 1);
	return sign | (uint16_t)((bits >> MANTISSAS_APART) - (EXPONENTS_APART << 10));
}

float model_unpack_half(uint16_t half)
{
	int exponent = half >> 10 & 31, mantissa = half & 1023;
	if (exponent == 31 && mantissa)
		return NAN;
	float size = exponent == 31 ? INFINITY
		     : exponent     ? ldexpf((float)(1024 + mantissa), exponent - 25)
				    : ldexpf((float)mantissa, -24);
	return half & 0x8000 ? -size : size;
}
