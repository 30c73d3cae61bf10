#include "render/scene-lines.h"
#include "process/model.h"
#include "process/vector3.h"
#include "render/scene.h"
#include <math.h>
#include <string.h>

/* Samples along a line, to see what runs beside it. */
#define SAMPLE_M     0.1f
#define SAMPLES_MOST 64
/* Cosine of the angle between lines that run beside each other. */
#define BESIDE 0.85f

static float distance_m(const float a[3], const float b[3])
{
	return vector3_length((const float[3]){ a[0] - b[0], a[1] - b[1], a[2] - b[2] });
}

/* ---- order ---- */

static float weight_of(const struct profile_line *l)
{
	return l->length_m * (0.25f + l->confidence);
}

static int by_weight(gconstpointer a, gconstpointer b, gpointer lines)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	const struct profile_line *l = lines;
	float u = weight_of(&l[x]), v = weight_of(&l[y]);
	return u != v ? (u < v) - (u > v) : (x > y) - (x < y);
}

/* ---- vertices ---- */

static void take_vertex(
	const profile_lines *p, uint32_t n, const double origin_m[3], struct scene_line_vertex *ret)
{
	const struct profile_vertex *v = &g_array_index(p->vertex, struct profile_vertex, n);
	for (int k = 0; k < 3; k++)
		ret->at_m[k] = (float)(p->origin_m[k] + (double)v->at_m[k] - origin_m[k]);
	for (int side = 0; side < 2; side++)
		model_unpack_normal(v->face[side], ret->face[side]);
}

static void take_line(scene_lines *s, uint32_t n, const profile_lines *p,
	const struct profile_line *from, const double origin_m[3])
{
	struct scene_line *l = &s->line[n];
	*l = (struct scene_line){ s->vertices, from->count, from->length_m, from->confidence,
		SCENE_LINES_APART_M, from->leaf, from->kind, from->closed };
	for (uint32_t k = 0; k < from->count; k++) {
		struct scene_line_vertex *v = &s->vertex[s->vertices++];
		take_vertex(p, from->first + k, origin_m, v);
		v->along_m = k ? v[-1].along_m + distance_m(v->at_m, v[-1].at_m) : 0;
	}
}

/* ---- what runs beside what ---- */

struct sample {
	float at_m[3], way[3];
	uint32_t line;
	int32_t next; /* in the same cell */
};

/* Cells of SCENE_LINES_APART_M a side. */
struct field {
	GHashTable *first; /* of each cell, 1 more than the sample's number */
	GArray *sample;
};

static gpointer key_of(const int cell[3])
{
	uint64_t h = 0;
	for (int k = 0; k < 3; k++)
		h = h << 21 ^ (uint64_t)(cell[k] & 0x1fffff);
	return GSIZE_TO_POINTER(h);
}

static void cell_of(const float at_m[3], int ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = (int)floorf(at_m[k] / SCENE_LINES_APART_M);
}

static void put(struct field *f, const struct sample *s)
{
	int cell[3];
	cell_of(s->at_m, cell);
	struct sample own = *s;
	own.next = GPOINTER_TO_INT(g_hash_table_lookup(f->first, key_of(cell))) - 1;
	g_array_append_val(f->sample, own);
	g_hash_table_insert(f->first, key_of(cell), GINT_TO_POINTER((int)f->sample->len));
}

static float apart_in(const struct field *f, const int cell[3], const struct sample *s, float apart)
{
	int n = GPOINTER_TO_INT(g_hash_table_lookup(f->first, key_of(cell))) - 1;
	for (; n >= 0; n = g_array_index(f->sample, struct sample, n).next) {
		const struct sample *o = &g_array_index(f->sample, struct sample, n);
		if (fabsf(vector3_dot(o->way, s->way)) < BESIDE)
			continue;
		apart = fminf(apart, distance_m(o->at_m, s->at_m));
	}
	return apart;
}

static float apart_of(const struct field *f, const struct sample *s)
{
	float apart = SCENE_LINES_APART_M;
	int middle[3];
	cell_of(s->at_m, middle);
	for (int n = 0; n < 27; n++) {
		int cell[3] = { middle[0] + n % 3 - 1, middle[1] + n / 3 % 3 - 1,
			middle[2] + n / 9 - 1 };
		apart = apart_in(f, cell, s, apart);
	}
	return apart;
}

static uint32_t sample_line(const scene_lines *s, uint32_t n, struct sample ret[SAMPLES_MOST])
{
	const struct scene_line *l = &s->line[n];
	const struct scene_line_vertex *v = &s->vertex[l->first];
	float all_m = v[l->count - 1].along_m;
	uint32_t count = (uint32_t)CLAMP(all_m / SAMPLE_M, 1, SAMPLES_MOST), at = 0;
	for (uint32_t k = 0; k < count; k++) {
		float along_m = all_m * ((float)k + 0.5f) / (float)count;
		while (at + 2 < l->count && v[at + 1].along_m < along_m)
			at++;
		float long_m = v[at + 1].along_m - v[at].along_m,
		      part = long_m > 0 ? (along_m - v[at].along_m) / long_m : 0;
		ret[k].line = n;
		for (int i = 0; i < 3; i++) {
			float step = v[at + 1].at_m[i] - v[at].at_m[i];
			ret[k].at_m[i] = v[at].at_m[i] + part * step;
			ret[k].way[i] = long_m > 0 ? step / long_m : 0;
		}
	}
	return count;
}

static int by_size(gconstpointer a, gconstpointer b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

static void set_apart(scene_lines *s)
{
	struct field f = { g_hash_table_new(NULL, NULL),
		g_array_new(FALSE, FALSE, sizeof(struct sample)) };
	for (uint32_t n = 0; n < s->lines; n++) {
		struct sample own[SAMPLES_MOST];
		float apart[SAMPLES_MOST];
		uint32_t count = sample_line(s, n, own);
		for (uint32_t k = 0; k < count; k++)
			apart[k] = apart_of(&f, &own[k]);
		qsort(apart, count, sizeof *apart, by_size);
		s->line[n].apart_m = apart[count / 2];
		for (uint32_t k = 0; k < count; k++)
			put(&f, &own[k]);
	}
	g_array_unref(f.sample);
	g_hash_table_unref(f.first);
}

/* ---- all ---- */

scene_lines *scene_lines_new(const profile_lines *p, const double origin_m[3])
{
	scene_lines *s = g_new0(scene_lines, 1);
	g_autofree uint32_t *order = g_new(uint32_t, p->line->len + 1);
	for (uint32_t n = 0; n < p->line->len; n++)
		order[n] = n;
	g_qsort_with_data(order, (int)p->line->len, sizeof *order, by_weight, p->line->data);
	s->serial = scene_serial();
	s->lines = p->line->len;
	s->line = g_new(struct scene_line, s->lines + 1);
	s->vertex = g_new(struct scene_line_vertex, p->vertex->len + 1);
	for (uint32_t n = 0; n < s->lines; n++)
		take_line(
			s, n, p, &g_array_index(p->line, struct profile_line, order[n]), origin_m);
	set_apart(s);
	return s;
}

void scene_lines_free(scene_lines *s)
{
	if (!s)
		return;
	g_free(s->line);
	g_free(s->vertex);
	g_free(s);
}
