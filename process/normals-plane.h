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
	vf count, u, v, uu, uv, vv; /* of the window: mean direction, relative; covariance */
	vf a, b, d;                 /* w = a * u + b * v + d, u and v of the tile */
	vf error_w2;                /* mean square of what remains, in w */
	vf centre_w;                /* of the plane at the mean direction, and there: */
	vf centre_u, centre_v;
};

INLINE struct fit fit_plane(const vf *s, vf here, float u_mean, float v_mean, float noise_m)
{
	struct fit f;
	f.good = (s[N] >= COUNT_MIN) & (here > 0);
	f.count = choose(f.good, s[N], all(1));
	vf part = 1 / f.count;
	vf w = s[W] * part;
	f.u = s[U] * part;
	f.v = s[V] * part;
	f.uu = s[UU] * part - f.u * f.u;
	f.uv = s[UV] * part - f.u * f.v;
	f.vv = s[VV] * part - f.v * f.v;
	vf uw = s[UW] * part - f.u * w, vw = s[VW] * part - f.v * w, ww = s[WW] * part - w * w;
	f.centre_u = f.u + u_mean;
	f.centre_v = f.v + v_mean;
	/* Where nothing is known, the surface faces the scanner. */
	vf facing = (w + here) / (1 + f.centre_u * f.centre_u + f.centre_v * f.centre_v);
	vf a0 = facing * f.centre_u, b0 = facing * f.centre_v;
	vf hold = noise_m * here * (1 / NORMALS_PRIOR_SLOPE);
	hold = hold * hold * part + 1e-14f;
	vf p = f.uu + hold, q = f.vv + hold;
	vf ra = uw - f.uu * a0 - f.uv * b0, rb = vw - f.uv * a0 - f.vv * b0;
	vf scale = 1 / (p * q - f.uv * f.uv);
	f.a = a0 + (ra * q - rb * f.uv) * scale;
	f.b = b0 + (rb * p - ra * f.uv) * scale;
	f.centre_w = here + w;
	f.d = f.centre_w - f.a * f.centre_u - f.b * f.centre_v;
	f.error_w2 = most(ww - 2 * (f.a * uw + f.b * vw) + f.a * f.a * f.uu + 2 * f.a * f.b * f.uv +
				  f.b * f.b * f.vv,
		all(0));
	f.good &= f.centre_w > 0;
	return f;
}

/* Where eight cells lie in the grid's planes. */
struct place {
	size_t at,
		below; /* below: how much further the same cells of the next row lie, which share the plane; 0: not */
	int lanes; /* that are the tile's */
};

INLINE void put(float *plane, struct place at, vf x)
{
	if (!plane)
		return;
	plane += at.at;
	if (at.lanes == LANES) {
		store(plane, x);
		store(plane + at.below, x);
	} else {
		memcpy(plane, &x, at.lanes * sizeof *plane);
		memcpy(plane + at.below, &x, at.lanes * sizeof *plane);
	}
}

INLINE vf turned(const tile *t, int k, vf x, vf y, vf z)
{
	return t->axis[0][k] * x + t->axis[1][k] * y + t->axis[2][k] * z;
}

/* The neighbours' places on the plane: moving by du, dv in direction moves the point by du * e + dv * f. */
INLINE void put_window(
	const tile *t, const struct normals_planes *p, struct place at, const struct fit *f)
{
	vf z = 1 / choose(f->good, f->centre_w, all(1));
	vf ea = f->a * z, eb = f->b * z;
	vf e[3] = { z * (1 - f->centre_u * ea), -z * f->centre_v * ea, -z * ea };
	vf g[3] = { -z * f->centre_u * eb, z * (1 - f->centre_v * eb), -z * eb };
	vf along[3], up[3];
	put(p->count, at, where(f->good, f->count));
	for (int k = 0; k < 3; k++) {
		put(p->centre_m[k], at, turned(t, k, f->centre_u * z, f->centre_v * z, z));
		along[k] = turned(t, k, e[0], e[1], e[2]);
		up[k] = turned(t, k, g[0], g[1], g[2]);
	}
	for (int k = 0, i = 0; i < 3; i++)
		for (int j = i; j < 3; j++)
			put(p->covariance_m2[k++], at,
				f->uu * along[i] * along[j] +
					f->uv * (along[i] * up[j] + up[i] * along[j]) +
					f->vv * up[i] * up[j]);
}

INLINE void put_plane(const tile *t, const struct normals_planes *p, struct place at,
	const struct fit *f, vf range, float noise_m)
{
	vf length = root(f->a * f->a + f->b * f->b + f->d * f->d),
	   inverse = 1 / choose(f->good, length, all(1));
	vf z = 1 / choose(f->good, f->centre_w, all(1));
	for (int k = 0; k < 3; k++)
		put(p->normal[k], at, where(f->good, -inverse * turned(t, k, f->a, f->b, f->d)));
	vf error = z * inverse * root(f->error_w2), none = all(NAN);
	put(p->error_m, at, choose(f->good, error, none));
	vi creased = f->error_w2 * range * range > CREASED_NOISES * CREASED_NOISES * noise_m *
							   noise_m * f->centre_w * f->centre_w;
	put(p->offset_m, at, where(f->good, choose(creased, -inverse, inverse)));
	if (p->curvature) {
		vf ea = f->a * z, eb = f->b * z, u = f->centre_u, v = f->centre_v,
		   one = 1 + u * u + v * v;
		vf spread = z * z *
			    (f->uu * (1 - 2 * u * ea + one * ea * ea) +
				    f->vv * (1 - 2 * v * eb + one * eb * eb) -
				    2 * f->uv * (u * eb + v * ea - one * ea * eb));
		vf least_m2 = least(error * error, spread * 0.5f);
		put(p->curvature, at,
			choose(f->good, least_m2 / most(spread + least_m2, all(1e-20f)), none));
	}
	if (p->count)
		put_window(t, p, at, f);
}

#endif
