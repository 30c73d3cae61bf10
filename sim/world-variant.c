/* The same place otherwise: things moved, or a half like the other. */
#include "sim/world-site.h"

void site_begin_loose(struct site *s, struct dice *ret_kept)
{
	*ret_kept = s->dice;
	if (s->variant.moved)
		s->dice = s->loose;
}

void site_end_loose(struct site *s, const struct dice *kept)
{
	if (s->variant.moved)
		s->dice = *kept;
}

float site_nudge(struct site *s, float most)
{
	return s->variant.moved ? roll_in(&s->loose, -most, most) : 0;
}

static vec half_turn(vec v)
{
	return (vec){ -v[0], -v[1], v[2] };
}

/* West, east, or across the middle. */
static int side_of(const struct mesh *m, const uint32_t corner[3])
{
	float low = 1e9f, high = -1e9f;
	for (int k = 0; k < 3; k++) {
		float x = g_array_index(m->points, vec, corner[k])[0];
		low = MIN(low, x);
		high = MAX(high, x);
	}
	return high <= 1e-3f ? -1 : low >= -1e-3f ? 1 : 0;
}

static uint32_t turned_point(struct mesh *m, uint32_t *copy, uint32_t i)
{
	if (!copy[i]) {
		vec point = half_turn(g_array_index(m->points, vec, i)),
		    normal = half_turn(g_array_index(m->normals, vec, i));
		copy[i] = m->points->len;
		g_array_append_val(m->points, point);
		g_array_append_val(m->normals, normal);
	}
	return copy[i];
}

static void turn_mesh(struct mesh *m)
{
	guint faces = m->faces->len;
	g_autofree uint32_t *copy = g_new0(uint32_t, m->points->len);
	g_autoptr(GArray) indices = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_autoptr(GArray) kept = g_array_new(FALSE, FALSE, sizeof(struct face));
	for (guint f = 0; f < faces; f++) {
		uint32_t corner[3];
		memcpy(corner, &g_array_index(m->indices, uint32_t, 3 * f), sizeof corner);
		struct face face = g_array_index(m->faces, struct face, f);
		int side = side_of(m, corner);
		if (side < 0)
			continue;
		g_array_append_vals(indices, corner, 3);
		g_array_append_val(kept, face);
		/* Also what crosses the middle: else it lies there on one side only, and leaves a gap beside its twin. */
		for (int k = 0; k < 3; k++)
			corner[k] = turned_point(m, copy, corner[k]);
		g_array_append_vals(indices, corner, 3);
		g_array_append_val(kept, face);
	}
	g_array_set_size(m->indices, 0);
	g_array_append_vals(m->indices, indices->data, indices->len);
	g_array_set_size(m->faces, 0);
	g_array_append_vals(m->faces, kept->data, kept->len);
}

void site_make_symmetric(struct site *s)
{
	turn_mesh(&s->solid);
	turn_mesh(&s->glass);
	g_autoptr(GArray) kept = g_array_new(FALSE, FALSE, sizeof(struct placement));
	for (guint i = 0; i < s->placements->len; i++) {
		struct placement p = g_array_index(s->placements, struct placement, i);
		if (p.at.o[0] < 0)
			continue;
		g_array_append_val(kept, p);
		p.at = (struct frame){ half_turn(p.at.x), half_turn(p.at.y), half_turn(p.at.z),
			half_turn(p.at.o) };
		g_array_append_val(kept, p);
	}
	g_array_set_size(s->placements, 0);
	g_array_append_vals(s->placements, kept->data, kept->len);
}
