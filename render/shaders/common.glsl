/* What all shaders share: the camera's snapshot, and light. In pictures y is down, as in memory: row 0 is the first one. */
precision highp float;
precision highp int;
precision highp sampler2D;
precision highp usampler2D;
precision highp sampler2DArray;

const uint MASK_EMPTY = 0x7f7fff00u;

/* The mask (mask.h), once it is drawn. */
layout(binding = 0) uniform usampler2D mask_keys;

layout(std140, binding = 0) uniform Camera {
	vec4 lens;         /* focal_px, middle x and y, near_m */
	vec4 rays;         /* struct lens: fan, parallel_m, 1 / parallel_m, begin_m */
	vec4 cuts;         /* 1: the near plane cuts; how thick, 0: as the layer has it; nothing is drawn farther than this; unit_m of the scene */
	vec4 turn[3];      /* site to camera: rows right, down, forward */
	vec4 size;         /* width, height, px to one of the style, far_m */
	vec4 paper;        /* linear r g b, grain */
	vec4 light[64];    /* linear, of sRGB bytes, four in one */
	vec4 light_from;   /* towards the style's light, as the camera sees it; its amount, 0: there is none */
	vec4 focus;        /* its middle, as the camera sees it; what fades far away from it */
	vec4 eye;          /* from the scene's origin */
	vec4 paint_light;  /* towards the light on paint (frame_paint_light) */
	vec4 focus_reach;  /* radius_m, 1 / falloff_m, abstraction, 1: there is one; 2: all of that is at depth 1; 3: it is a segment */
	ivec4 window;      /* where in the whole picture this one begins */
};

/* scene_exposed() */
vec3 exposed(float times, vec3 srgb)
{
	return srgb * times / (1.0 + (times - 1.0) * srgb);
}

/* LENS_SCALE_M() */
float scale_m(float depth_m)
{
	return depth_m * rays.x + rays.y;
}

/* LENS_STRETCH() */
float stretch(float depth_m)
{
	return rays.x + depth_m * rays.z;
}

/* The place at a depth that is seen at a place of the picture. */
vec3 seen_place(vec2 at, float depth_m)
{
	return vec3((at - lens.yz) / lens.x * scale_m(depth_m), depth_m);
}

float light_of_byte(uint b)
{
	return light[b >> 2][b & 3u];
}

vec3 light_of_bytes(uint rgba)
{
	return vec3(light_of_byte(rgba & 255u), light_of_byte(rgba >> 8 & 255u),
		light_of_byte(rgba >> 16 & 255u));
}

/* frame_diffuse() */
float diffuse_of(vec3 normal)
{
	return 0.5 + 0.5 * dot(normal, light_from.xyz);
}

/* What is left of a lightness in the style's light. */
float lit_of(vec3 normal)
{
	return 1.0 - light_from.w * (1.0 - diffuse_of(normal));
}

/* frame_away() */
float away_of(vec3 at, bool is_focus)
{
	if (focus_reach.w <= 0.0)
		return 0.0;
	if (focus_reach.w > 2.5)
		return is_focus ? 0.0 : 1.0;
	vec3 place = focus_reach.w > 1.5 ? vec3(at.xy / scale_m(at.z), 1.0) : at;
	float part = clamp((distance(place, focus.xyz) - focus_reach.x) * focus_reach.y, 0.0, 1.0);
	return part * part * (3.0 - 2.0 * part);
}

float mask_depth(uint key)
{
	return uintBitsToFloat(key & 0xffffff00u);
}
