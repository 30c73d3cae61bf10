#ifndef PROCESS_VECTOR3_H
#define PROCESS_VECTOR3_H
/* Three floats: points and directions of single precision. */
#include <math.h>
#include <stdbool.h>

static inline float vector3_dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* ret is neither of both. */
static inline void vector3_cross(const float a[3], const float b[3], float ret[3])
{
	ret[0] = a[1] * b[2] - a[2] * b[1];
	ret[1] = a[2] * b[0] - a[0] * b[2];
	ret[2] = a[0] * b[1] - a[1] * b[0];
}

static inline float vector3_length(const float v[3])
{
	return sqrtf(vector3_dot(v, v));
}

/* a += by * b */
static inline void vector3_add(float a[3], float by, const float b[3])
{
	for (int k = 0; k < 3; k++)
		a[k] += by * b[k];
}

/* false: it has no length, and is left as it is. */
static inline bool vector3_unit(float v[3])
{
	float length = vector3_length(v);
	if (!(length > 1e-9f))
		return false;
	for (int k = 0; k < 3; k++)
		v[k] /= length;
	return true;
}

#endif
