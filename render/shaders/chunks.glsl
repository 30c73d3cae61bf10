/* Points of the scene, and the chunks that are in view: a run of them that have one pipeline (gles-views.h). */
struct chunk_view {
	vec4 base, axis[3];  /* camera coordinates of a point: base + q . axis; base.w: near_m of its box, axis[0].w: nearest_m */
	vec4 box;            /* on the screen, with all that its discs cover: left, top, right, bottom */
	vec4 mask;           /* disc, offset_m, offset_relative; 1 where backs are hidden */
	vec4 splat;          /* size, radius_least; size 0: shows no points; z: spacing_most_m, w: disc_most_m of all kinds */
	vec4 spacing_most_m; /* of each kind's list */
	vec4 crown;          /* of paint: the middle of its leaf, as the camera sees it; cell_m, below 0 where it is leafy */
	uvec4 kind_end;
	uvec4 at; /* first point in the slab, what chance knows it by, count, how many of the first may stand for all (disc_end), with the bits below */
	uvec4 pipeline;      /* and the chunk, its leaf, bits of the part of all points that it has */
	uvec4 paint;         /* its mean colour */
};
layout(std430, binding = 0) readonly buffer Points {
	uvec4 points[]; /* q0 q1, q2 spacing, disc degree kind, normal */
};
layout(std430, binding = 1) readonly buffer Views {
	chunk_view views[];
};
layout(location = 0) uniform uint first_view;

/* Points on planes are not drawn as discs; the mask hides all strokes. */
const uint PLANES_STAND = 0x80000000u, NO_STROKES = 0x40000000u;
/* Of a view, and which of them is at.w. */
const uint VIEW_WORDS = 52u, VIEW_DISCS = 43u;

#define UNIT_M cuts.w

/* Camera coordinates. */
vec3 place_of(uint n, uvec4 p)
{
	return views[n].base.xyz + float(p.x & 0xffffu) * views[n].axis[0].xyz +
	       float(p.x >> 16) * views[n].axis[1].xyz + float(p.y & 0xffffu) * views[n].axis[2].xyz;
}

/* A packed normal, in the site's frame; 0 0 0 where there is none. */
vec3 unpacked(uint bits)
{
	int first = int(bits << 16) >> 16, second = int(bits) >> 16;
	if (first == -32768)
		return vec3(0.0);
	vec3 v = vec3(float(first), float(second), 0.0) * (1.0 / 32767.0);
	v.z = 1.0 - abs(v.x) - abs(v.y);
	float over = max(-v.z, 0.0);
	v.x += v.x >= 0.0 ? -over : over;
	v.y += v.y >= 0.0 ? -over : over;
	return v / sqrt(dot(v, v));
}

/* From the site's frame to the camera's. */
vec3 to_camera(vec3 v)
{
	return vec3(dot(turn[0].xyz, v), dot(turn[1].xyz, v), dot(turn[2].xyz, v));
}

vec3 turned(uint bits)
{
	return to_camera(unpacked(bits));
}
