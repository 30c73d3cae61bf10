#include "process/features-private.h"
#include "process/model.h"
#include "process/vector3.h"
#include <string.h>

#define NEIGHBOURS_LEAST 6

struct feature_frame feature_frame_of(const float normal[3])
{
	struct feature_frame f;
	const float level = sqrtf(normal[0] * normal[0] + normal[1] * normal[1]);
	memcpy(f.normal, normal, sizeof f.normal);
	f.first[0] = level > 1e-3f ? -normal[1] / level : 1;
	f.first[1] = level > 1e-3f ? normal[0] / level : 0;
	f.first[2] = level > 1e-3f ? 0
				   : -normal[0] / fmaxf(fabsf(normal[2]), 1e-6f) *
					     (normal[2] < 0 ? -1 : 1);
	for (int k = 0; k < 3; k++)
		f.second[k] = normal[(k + 1) % 3] * f.first[(k + 2) % 3] -
			      normal[(k + 2) % 3] * f.first[(k + 1) % 3];
	return f;
}

void feature_form_add(struct feature_form *s, const struct feature_frame *f, const float off[3],
	const float there[3], int way)
{
	if (!feature_form_is_same_face(vector3_dot(off, off), vector3_dot(off, f->normal),
		    vector3_dot(there, f->normal)))
		return;
	float a = vector3_dot(off, f->first), b = vector3_dot(off, f->second),
	      p = vector3_dot(there, f->first), q = vector3_dot(there, f->second);
	s->a += a;
	s->b += b;
	s->p += p;
	s->q += q;
	s->aa += a * a;
	s->ab += a * b;
	s->bb += b * b;
	s->ap += a * p;
	s->aq_bp += a * q + b * p;
	s->bq += b * q;
	s->count++;
	s->ways |= 1u << way;
}

/* Neighbours on all sides, or at least on three of the four axes: an edge's own side alone tells nothing. */
static bool is_around(const struct feature_form *s)
{
	unsigned both = s->ways & s->ways >> 4 & 15;
	return s->count >= NEIGHBOURS_LEAST && (both & (both - 1));
}

/* The symmetric matrix that takes a step to the change of the normal, by least squares. The point's own normal is one of them, as
 * noisy as the others. False: it is not determined. */
static bool solve(const struct feature_form *s, float ret[3])
{
	const float n = 1.f / (float)(s->count + 1), aa = s->aa - n * s->a * s->a,
		    ab = s->ab - n * s->a * s->b, bb = s->bb - n * s->b * s->b;
	const float m[3][3] = { { aa, ab, 0 }, { ab, aa + bb, ab }, { 0, ab, bb } };
	const float r[3] = { s->ap - n * s->a * s->p, s->aq_bp - n * (s->a * s->q + s->b * s->p),
		s->bq - n * s->b * s->q };
	float c00 = m[1][1] * m[2][2] - m[1][2] * m[2][1], c01 = -(m[1][0] * m[2][2]),
	      c02 = m[1][0] * m[2][1];
	float det = m[0][0] * c00 + m[0][1] * c01, c11 = m[0][0] * m[2][2],
	      c12 = -(m[0][0] * m[1][2]);
	float c22 = m[0][0] * m[1][1] - m[0][1] * m[1][0], scale = aa + bb;
	if (!(det > 1e-4f * scale * scale * scale))
		return false;
	ret[0] = (c00 * r[0] + c01 * r[1] + c02 * r[2]) / det;
	ret[1] = (c01 * r[0] + c11 * r[1] + c12 * r[2]) / det;
	ret[2] = (c02 * r[0] + c12 * r[1] + c22 * r[2]) / det;
	return true;
}

void feature_form_keep(
	const struct feature_form *form, const struct feature_frame *frame, features *f, size_t i)
{
	float s[3];
	if (!is_around(form) || !solve(form, s))
		return;
	float mean = 0.5f * (s[0] + s[2]), half = 0.5f * (s[0] - s[2]),
	      apart = sqrtf(half * half + s[1] * s[1]), along[3];
	/* Half the angle of (half, s[1]), without its sine. */
	float cosine = apart > 0 ? sqrtf(fmaxf(0.5f + 0.5f * half / apart, 0)) : 1;
	float sine = apart > 0 ? copysignf(sqrtf(fmaxf(0.5f - 0.5f * half / apart, 0)), s[1]) : 0;
	f->k1[i] = mean + apart;
	f->k2[i] = mean - apart;
	if (fabsf(f->k2[i]) > fabsf(f->k1[i])) {
		float swap = f->k1[i], turned = -sine;
		f->k1[i] = f->k2[i];
		f->k2[i] = swap;
		sine = cosine;
		cosine = turned;
	}
	for (int k = 0; k < 3; k++)
		along[k] = cosine * frame->first[k] + sine * frame->second[k];
	model_pack_normal(along, f->principal[i]);
}
