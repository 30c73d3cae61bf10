#include "process/profile-around.h"
#include "process/vector3.h"
#include <string.h>

#define CELL_M 0.125f

struct stored {
	float at_m[3];
	int16_t normal[2];
	uint16_t spacing;
	uint8_t flags, is_feature;
};

struct profile_around {
	uint32_t mask;
	uint32_t *first; /* of each number, and the end */
	struct stored *stored;
};

static uint32_t number_of(uint32_t mask, int32_t x, int32_t y, int32_t z)
{
	uint32_t v =
		(uint32_t)x * 0x9E3779B1u ^ (uint32_t)y * 0x85EBCA77u ^ (uint32_t)z * 0xC2B2AE3Du;
	v ^= v >> 15;
	v *= 0x2C1B3C6Du;
	v ^= v >> 13;
	return v & mask;
}

static int32_t cell_of(float m)
{
	return (int32_t)floorf(m / CELL_M);
}

static struct stored stored_of(
	const struct model_chunk *c, const struct model_point *p, const double origin_m[3])
{
	struct stored s = { .spacing = p->spacing,
		.flags = p->flags,
		.is_feature = p->kind >= FEATURE_UNDIRECTED };
	for (int k = 0; k < 3; k++)
		s.at_m[k] = (float)(c->centre_m[k] - origin_m[k] + (double)p->position_m[k]);
	memcpy(s.normal, p->normal, sizeof s.normal);
	return s;
}

/* Counts first, then puts each in its place. */
static void fill(profile_around *a, const model *m, const double origin_m[3], bool is_count)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	for (uint64_t n = 0; n < chunks; n++) {
		const struct model_point *p = model_points(m) + chunk[n].first;
		for (uint32_t i = 0; i < chunk[n].points; i++) {
			struct stored s = stored_of(&chunk[n], &p[i], origin_m);
			uint32_t number = number_of(a->mask, cell_of(s.at_m[0]), cell_of(s.at_m[1]),
				cell_of(s.at_m[2]));
			if (is_count)
				a->first[number + 1]++;
			else
				a->stored[a->first[number]++] = s;
		}
		product_forget(model_file(m), p, chunk[n].points * sizeof *p);
	}
}

profile_around *profile_around_new(const model *m, const double origin_m[3])
{
	profile_around *a = g_new0(profile_around, 1);
	uint64_t count = model_count(m);
	a->mask = 1023;
	while (a->mask < count / 4)
		a->mask = 2 * a->mask + 1;
	a->first = g_new0(uint32_t, a->mask + 3);
	a->stored = g_new(struct stored, count + 1);
	fill(a, m, origin_m, true);
	for (uint32_t n = 0; n <= a->mask; n++)
		a->first[n + 1] += a->first[n];
	fill(a, m, origin_m, false);
	/* Each now stands where its next begins. */
	memmove(a->first + 1, a->first, (a->mask + 1) * sizeof *a->first);
	a->first[0] = 0;
	return a;
}

void profile_around_free(profile_around *a)
{
	if (!a)
		return;
	g_free(a->first);
	g_free(a->stored);
	g_free(a);
}

/* ---- what is around ---- */

struct query {
	const struct profile_frame *frame;
	float at[3], from_m, to_m, radius_m;
	GArray *found;
};

static void look_at(const struct query *q, const struct stored *s)
{
	const struct profile_frame *f = q->frame;
	float off[3], normal[3];
	struct profile_near near;
	for (int k = 0; k < 3; k++)
		off[k] = s->at_m[k] - q->at[k];
	near.t = vector3_dot(off, f->axis[2]);
	if (near.t < q->from_m || near.t > q->to_m)
		return;
	near.u = vector3_dot(off, f->axis[0]);
	near.v = vector3_dot(off, f->axis[1]);
	if (near.u * near.u + near.v * near.v > q->radius_m * q->radius_m)
		return;
	model_unpack_normal(s->normal, normal);
	for (int k = 0; k < 3; k++)
		near.normal[k] = vector3_dot(normal, f->axis[k]);
	near.spacing_m = (float)s->spacing * 1e-4f;
	near.flags = s->flags;
	near.is_feature = s->is_feature;
	g_array_append_val(q->found, near);
}

/* The points of a cube; others with the same number come too, and are not in it. */
static void look_in(const profile_around *a, const struct query *q, const int32_t cell[3])
{
	uint32_t number = number_of(a->mask, cell[0], cell[1], cell[2]);
	for (uint32_t i = a->first[number]; i < a->first[number + 1]; i++) {
		const struct stored *s = &a->stored[i];
		if (cell_of(s->at_m[0]) == cell[0] && cell_of(s->at_m[1]) == cell[1] &&
			cell_of(s->at_m[2]) == cell[2])
			look_at(q, s);
	}
}

/* Step by step along the line the cubes around it whose middles lie beside that step. */
void profile_around_look(const profile_around *a, const struct profile_frame *f, double from_m,
	double to_m, float radius_m, GArray *ret)
{
	struct query q = { f, { 0 }, (float)from_m, (float)to_m, radius_m, ret };
	const float reach = radius_m + 0.867f * CELL_M;
	int first = (int)floor((from_m - (double)CELL_M) / (double)CELL_M),
	    last = (int)floor((to_m + (double)CELL_M) / (double)CELL_M);
	g_array_set_size(ret, 0);
	for (int k = 0; k < 3; k++)
		q.at[k] = (float)f->at[k];
	for (int step = first; step <= last; step++) {
		int32_t low[3], high[3], cell[3];
		for (int k = 0; k < 3; k++) {
			float middle = q.at[k] + ((float)step + 0.5f) * CELL_M * f->axis[2][k];
			low[k] = cell_of(middle - reach - CELL_M / 2);
			high[k] = cell_of(middle + reach + CELL_M / 2);
		}
		for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
			for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
				for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++) {
					float off[3], square = 0;
					for (int k = 0; k < 3; k++)
						off[k] = ((float)cell[k] + 0.5f) * CELL_M - q.at[k];
					float t = vector3_dot(off, f->axis[2]);
					for (int k = 0; k < 3; k++)
						square += (off[k] - t * f->axis[2][k]) *
							  (off[k] - t * f->axis[2][k]);
					if ((int)floorf(t / CELL_M) == step &&
						square <= reach * reach)
						look_in(a, &q, cell);
				}
	}
}
