#include "render/project-lanes.h"
#include "render/stipple-texture.h"

/* Integers that are not below least and not above most. */
INLINE vi within(vi x, int32_t least, int32_t most)
{
	vi low = x<least, high = x> most;
	return (x & ~(low | high)) | (low & least) | (high & most);
}

INLINE vi key_of(const struct stipple_plane *p, vf depth_m, vi point)
{
	/* Behind the eye is nowhere, but its bits are those of no number to count with. */
	vf ahead_m = most(depth_m, all(0));
	vi steps = within(((vi)ahead_m - p->low) >> p->shift, 0, STIPPLE_DEPTH_MOST);
	vi tie = (vi)((vu)point * 0x9E3779B9u >> (32 - STIPPLE_TIE_BITS));
	return steps << STIPPLE_TIE_BITS | tie;
}

/* -1 where it is outside. */
INLINE vi place_of(const struct stipple_plane *p, const vf at[3])
{
	vf scale = p->is_parallel ? all(p->scale) : p->scale / at[2];
	vf x = p->middle[0] + at[0] * scale, y = p->middle[1] + at[1] * scale;
	float edge = STIPPLE_RINGS_MOST;
	vi inside = (at[2] >= p->near_m) & (at[2] <= p->far_m) & (x >= edge) & (y >= edge) &
		    (x < (float)p->columns - edge) & (y < (float)p->rows - edge);
	vi column = __builtin_convertvector(where(inside, x), vi),
	   row = __builtin_convertvector(where(inside, y), vi);
	return (row * p->pitch + column) | ~inside;
}

void LANES_NAME(stipple_project)(const struct stipple_plane *p, const scene *s,
	const struct chunk_view *v, uint32_t count, int32_t *ret_place, int32_t *ret_key)
{
	static const vi order = { 0, 1, 2, 3, 4, 5, 6, 7 };
	for (uint32_t i = 0; i < count; i += LANES) {
		uint32_t first = v->chunk->first + i;
		struct lane_places l = load_places(s->place + first);
		vf at[3];
		for (int k = 0; k < 3; k++)
			at[k] = v->base[k] + l.q[0] * v->axis[0][k] + l.q[1] * v->axis[1][k] +
				l.q[2] * v->axis[2][k];
		store_mask(ret_place + i, place_of(p, at));
		vi id = (int32_t)first + order;
		if (s->id)
			id = load_mask((const int32_t *)(const void *)(s->id + first));
		store_mask(ret_key + i, key_of(p, at[2], id));
	}
}

/* What is around a texel is deeper by the step where it is written there, so the texel itself may be looked at too. */
void LANES_NAME(stipple_spread_row)(
	const int32_t *from, int32_t *to, int32_t pitch, int32_t columns, int32_t row, int32_t step)
{
	from += (ptrdiff_t)row * pitch;
	to += (ptrdiff_t)row * pitch;
	for (int32_t x = 1; x < columns - 1; x += LANES) {
		const int32_t *at = from + x;
		vi least = load_mask(at);
		for (int32_t k = -pitch; k <= pitch; k += pitch)
			for (int32_t side = -1; side <= 1; side++)
				least = lower(least, load_mask(at + k + side));
		store_mask(to + x, lower(load_mask(at), least + step));
	}
	/* Whole vectors reach over the edge. */
	for (int32_t x = columns - 1; x < pitch; x++)
		to[x] = STIPPLE_EMPTY;
}
