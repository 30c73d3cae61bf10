#ifndef PROCESS_NORMALS_PLANE_H
#define PROCESS_NORMALS_PLANE_H
/* From the sums of eight windows their planes, and those into the grid's. Internal to normals-tile.c. */
#include "process/normals-frame.h"

/* Fewer cells than these make no plane. */
#define COUNT_MIN 4
/* A fit leaves about the noise along the rays. What leaves this much more reaches over a crease. */
#define CREASED_NOISES 1.35f

struct fit {
	vi good;
	vf count, u, v, uu, uv, vv; /* of the window: mean direction, its covariance */
	vf a, b, d;                 /* w = a * u + b * v + d, u and v of the tile */
	vf error_w2;                /* mean square of what remains, in w */
	vf centre_w;                /* of the plane at the mean direction */
};

INLINE struct fit fit_plane(const struct sums *s, vf here, float noise_m)
{
	struct fit f;
	f.good = (s->n >= COUNT_MIN) & (here > 0);
	f.count = choose(f.good, s->n, all(1));
	vf part = 1 / f.count;
	vf w = s->w * part;
	f.u = s->u * part;
	f.v = s->v * part;
	f.uu = most(s->uu * part - f.u * f.u, all(0)); /* of one column: but for rounding */
	f.uv = s->uv * part - f.u * f.v;
	f.vv = most(s->vv * part - f.v * f.v, all(0));
	vf uw = s->uw * part - f.u * w, vw = s->vw * part - f.v * w, ww = s->ww * part - w * w;
	/* Where nothing is known, the surface faces the scanner. */
	vf facing = (w + here) / (1 + f.u * f.u + f.v * f.v);
	vf a0 = facing * f.u, b0 = facing * f.v;
	vf hold = noise_m * here * (1 / NORMALS_PRIOR_SLOPE);
	hold = hold * hold * part + 1e-14f;
	vf p = f.uu + hold, q = f.vv + hold;
	vf ra = uw - f.uu * a0 - f.uv * b0, rb = vw - f.uv * a0 - f.vv * b0;
	vf scale = 1 / (p * q - f.uv * f.uv);
	f.a = a0 + (ra * q - rb * f.uv) * scale;
	f.b = b0 + (rb * p - ra * f.uv) * scale;
	f.centre_w = here + w;
	f.d = f.centre_w - f.a * f.u - f.b * f.v;
	f.error_w2 = most(ww - 2 * (f.a * uw + f.b * vw) + f.a * f.a * f.uu + 2 * f.a * f.b * f.uv +
				  f.b * f.b * f.vv,
		all(0));
	f.good &= f.centre_w > 0;
	return f;
}

/* Where a group's cells lie in the grid's planes. */
struct place {
	size_t at,
		below; /* below: how much further the same cells of the next row lie, which share the plane; 0: not */
	int columns;  /* that are the tile's */
	size_t ahead; /* how much further it is written next but one */
};

INLINE void put(float *plane, struct place at, vf even, vf odd)
{
	if (!plane)
		return;
	plane += at.at;
	/* Else all waits for memory that is written for the first time. */
	__builtin_prefetch(plane + at.ahead, 1);
	__builtin_prefetch(plane + at.ahead + at.below, 1);
	vf x[2] = { first_half(even, odd), second_half(even, odd) };
	if (at.columns >= GROUP) {
		for (int half = 0; half < 2; half++) {
			store(plane + half * LANES, x[half]);
			store(plane + half * LANES + at.below, x[half]);
		}
	} else {
		memcpy(plane, x, at.columns * sizeof *plane);
		memcpy(plane + at.below, x, at.columns * sizeof *plane);
	}
}

INLINE vf turned(const tile *t, int k, vf x, vf y, vf z)
{
	return t->axis[0][k] * x + t->axis[1][k] * y + t->axis[2][k] * z;
}

/* What the grid's planes hold. */
struct plane {
	vf normal[3], error_m, offset_m, curvature;
};

INLINE struct plane plane_of(const tile *t, const struct fit *f, vf range, float noise_m)
{
	struct plane p;
	vf length = root(f->a * f->a + f->b * f->b + f->d * f->d),
	   inverse = 1 / choose(f->good, length, all(1));
	vf z = 1 / choose(f->good, f->centre_w, all(1)), none = all(NAN);
	for (int k = 0; k < 3; k++)
		p.normal[k] = where(f->good, -inverse * turned(t, k, f->a, f->b, f->d));
	vf error = z * inverse * root(f->error_w2);
	p.error_m = choose(f->good, error, none);
	vi creased = f->error_w2 * range * range > CREASED_NOISES * CREASED_NOISES * noise_m *
							   noise_m * f->centre_w * f->centre_w;
	p.offset_m = where(f->good, choose(creased, -inverse, inverse));
	vf ea = f->a * z, eb = f->b * z, u = f->u, v = f->v, one = 1 + u * u + v * v;
	vf spread = z * z *
		    (f->uu * (1 - 2 * u * ea + one * ea * ea) +
			    f->vv * (1 - 2 * v * eb + one * eb * eb) -
			    2 * f->uv * (u * eb + v * ea - one * ea * eb));
	spread = most(spread, all(0));
	vf least_m2 = least(error * error, spread * 0.5f);
	p.curvature = choose(f->good, least_m2 / most(spread + least_m2, all(1e-20f)), none);
	return p;
}

/* The neighbours' places on the plane: moving by du, dv in direction moves the point by du * e + dv * f. */
struct window {
	vf count, centre_m[3], covariance_m2[6];
};

INLINE struct window window_of(const tile *t, const struct fit *f)
{
	struct window p;
	vf z = 1 / choose(f->good, f->centre_w, all(1));
	vf ea = f->a * z, eb = f->b * z;
	vf e[3] = { z * (1 - f->u * ea), -z * f->v * ea, -z * ea };
	vf g[3] = { -z * f->u * eb, z * (1 - f->v * eb), -z * eb };
	vf along[3], up[3];
	p.count = where(f->good, f->count);
	for (int k = 0; k < 3; k++) {
		p.centre_m[k] = turned(t, k, f->u * z, f->v * z, z);
		along[k] = turned(t, k, e[0], e[1], e[2]);
		up[k] = turned(t, k, g[0], g[1], g[2]);
	}
	for (int k = 0, i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			p.covariance_m2[k++] = f->uu * along[i] * along[j] +
					       f->uv * (along[i] * up[j] + up[i] * along[j]) +
					       f->vv * up[i] * up[j];
	return p;
}

INLINE void put_planes(const struct normals_planes *p, struct place at, const struct plane *even,
	const struct plane *odd)
{
	for (int k = 0; k < 3; k++)
		put(p->normal[k], at, even->normal[k], odd->normal[k]);
	put(p->error_m, at, even->error_m, odd->error_m);
	put(p->curvature, at, even->curvature, odd->curvature);
	at.at -= p->offset_from;
	put(p->offset_m, at, even->offset_m, odd->offset_m);
}

INLINE void put_windows(const struct normals_planes *p, struct place at, const struct window *even,
	const struct window *odd)
{
	put(p->count, at, even->count, odd->count);
	for (int k = 0; k < 3; k++)
		put(p->centre_m[k], at, even->centre_m[k], odd->centre_m[k]);
	for (int k = 0; k < 6; k++)
		put(p->covariance_m2[k], at, even->covariance_m2[k], odd->covariance_m2[k]);
}

#endif
