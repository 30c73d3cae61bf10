#include "render/filter-lanes.h"
#include "render/filter-solid.h"
#include "render/project-lanes.h"

INLINE vf eased(vf t)
{
	return t * t * t * (t * (6 * t - 15) + 10);
}

INLINE vi mixed(vi h)
{
	vu u = (vu)h;
	u ^= u >> 15;
	u *= 0x2c1b3c6du;
	u ^= u >> 12;
	u *= 0x297a2d39u;
	u ^= u >> 15;
	return (vi)u;
}

/* Of the corner's slope, one of the eight diagonals. */
INLINE vf corner(vi hash, const vf d[3])
{
	vf sum = { 0 };
	for (int k = 0; k < 3; k++)
		sum += (vf)((vi)d[k] ^ ((hash << (29 + k)) & INT32_MIN));
	return sum;
}

/* Gradient noise (Perlin 2002) at a place within a cell of the lattice. */
INLINE vf noise_in(const vi cell[3], const vf d[3], vi seed)
{
	static const uint32_t by[3] = { 0x8da6b343u, 0xd8163841u, 0xcb1ab31fu };
	vu part[3][2];
	vf of[8];
	for (int k = 0; k < 3; k++) {
		part[k][0] = (vu)cell[k] * by[k];
		part[k][1] = part[k][0] + by[k];
	}
	for (int n = 0; n < 8; n++) {
		vf away[3] = { d[0] - (float)(n & 1), d[1] - (float)(n >> 1 & 1),
			d[2] - (float)(n >> 2) };
		vu h = part[0][n & 1] ^ part[1][n >> 1 & 1] ^ part[2][n >> 2] ^ (vu)seed;
		of[n] = corner(mixed((vi)h), away);
	}
	vf t[3] = { eased(d[0]), eased(d[1]), eased(d[2]) };
	for (int n = 0; n < 4; n++)
		of[n] = of[2 * n] + t[0] * (of[2 * n + 1] - of[2 * n]);
	of[0] += t[1] * (of[1] - of[0]);
	of[2] += t[1] * (of[3] - of[2]);
	return 0.78f * (of[0] + t[2] * (of[2] - of[0]));
}

/* The places of eight pixels from the eye, in metres. */
INLINE void places(const struct filter_job *j, vf x, float y, vf depth_m, vf ret[3])
{
	const struct camera *c = &j->f->camera;
	const struct lens l = lens_of(c);
	float by_focal = 1 / (float)c->focal_px,
	      down = (y + (float)j->image.top + 0.5f - l.middle_y) * by_focal;
	vf right = (x + ((float)j->image.left + 0.5f - l.middle_x)) * by_focal;
	vf part = LENS_SCALE_M(&l, depth_m) / depth_m;
	for (int k = 0; k < 3; k++)
		ret[k] = ((float)c->right[k] * (right * part) + (float)c->down[k] * (down * part) +
				 (float)c->forward[k]) *
			 depth_m;
}

typedef vf at_eight(const void *job, vf x, float y, vf depth_m);

/* Of rows, eight pixels at a time. */
INLINE void each_eight(const struct filter_image *i, const float *depth_m, float *to, uint32_t from,
	uint32_t end, at_eight *at, const void *job)
{
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x += LANES) {
			size_t here = (size_t)y * i->width + x,
			       count = MIN(LANES, i->width - x) * sizeof(float);
			vf deep = all(FILTER_FAR);
			memcpy(&deep, depth_m + here, count);
			vf found = at(job, (float)x + lane_number, (float)y, deep);
			memcpy(to + here, &found, count);
		}
}

/* Of one octave of metres. */
INLINE vf octave_of(const struct filter_noise_job *n, const vf away_m[3], vi octave)
{
	vf by_cell = (vf)((127 - octave) << 23), d[3];
	vi cell[3], at = octave - FILTER_NOISE_LOWEST;
	for (int k = 0; k < 3; k++) {
		vf place = away_m[k] * by_cell + (vf)gather(n->within[k], at, 4);
		vi low = floor_of(place);
		d[k] = place - __builtin_convertvector(low, vf);
		cell[k] = low + gather(n->cell[k], at, 4);
	}
	/* Each octave is a noise of its own, and stays that when it becomes the other one of two. */
	return noise_in(cell, d, (vi)((vu)(octave + 64) * 0x9e3779b9u) + (int32_t)n->seed);
}

INLINE vf noise_at(const void *data, vf x, float y, vf depth_m)
{
	const struct filter_noise_job *n = data;
	const struct filter_job *j = n->j;
	vi is_far = depth_m >= FILTER_FAR;
	vf near_m = choose(is_far, all(1), depth_m), away_m[3];
	const struct lens l = lens_of(&j->f->camera);
	vf octave = log2_of(LENS_SCALE_M(&l, near_m) * (n->grain_px / l.focal_px));
	octave = least(most(octave, all(FILTER_NOISE_LOWEST)),
		all(FILTER_NOISE_LOWEST + FILTER_NOISE_OCTAVES - 2));
	vi whole = floor_of(octave);
	vf part = octave - __builtin_convertvector(whole, vf);
	places(j, x, y, near_m, away_m);
	vf fine = octave_of(n, away_m, whole), coarse = octave_of(n, away_m, whole + 1);
	vf ret = (fine + part * (coarse - fine)) / root(part * part + (1 - part) * (1 - part));
	if (!any(is_far))
		return ret;
	float by_grain = 1 / n->grain_px;
	vf flat[3] = { (x + (float)filter_whole_left(j)) * by_grain,
		all((y + (float)filter_whole_top(j)) * by_grain), all(0.5f) };
	vi cell[3];
	for (int k = 0; k < 3; k++) {
		cell[k] = floor_of(flat[k]);
		flat[k] -= __builtin_convertvector(cell[k], vf);
	}
	return choose(is_far, noise_in(cell, flat, (vi){ 0 } + (int32_t)n->seed), ret);
}

void LANES_NAME(filter_noise_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_noise_job *n = data;
	each_eight(&n->j->image, n->depth_m, n->to, from, end, noise_at, n);
}

/* ---- waves ---- */

/* Of a whole turn, in its part of it, within 0.001. */
INLINE vf sine_of_turn(vf turns)
{
	vf part = turns - __builtin_convertvector(floor_of(turns + 0.5f), vf),
	   bow = 8 * part - 16 * part * magnitude(part);
	return bow * (0.775f + 0.225f * magnitude(bow));
}

INLINE vf waves_at(const void *data, vf x, float y, vf depth_m)
{
	const struct filter_waves_job *w = data;
	const struct lens l = lens_of(&w->j->f->camera);
	vi is_far = depth_m >= FILTER_FAR;
	vf near_m = choose(is_far, all(1), depth_m), away_m[3], sum = { 0 };
	vf octave = log2_of(LENS_SCALE_M(&l, near_m) * (w->shortest_px / l.focal_px));
	places(w->j, x, y, near_m, away_m);
	for (int n = 0; n < FILTER_WAVES; n++) {
		const float *way = w->way[n], length_m = w->length_m[n];
		vf there =
			least(most((float)(n + FILTER_WAVES_LOWEST + 1) - octave, all(0)), all(1));
		if (!any(there > 0))
			continue;
		vf along_m = way[0] * away_m[0] + way[1] * away_m[1] + way[2] * away_m[2];
		sum += there * length_m * sine_of_turn(along_m / length_m + w->at_eye[n]);
	}
	return choose(is_far, (vf){ 0 }, sum);
}

void LANES_NAME(filter_waves_rows)(const void *data, uint32_t from, uint32_t end)
{
	const struct filter_waves_job *w = data;
	each_eight(&w->j->image, w->depth_m, w->to, from, end, waves_at, w);
}
