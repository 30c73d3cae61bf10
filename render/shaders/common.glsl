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
	vec4 turn[3];      /* site to camera: rows right, down, forward */
	vec4 size;         /* width, height, px to one of the style, far_m */
	vec4 paper;        /* linear r g b, grain */
	vec4 light[64];    /* linear, of sRGB bytes, four in one */
};

float light_of_byte(uint b)
{
	return light[b >> 2][b & 3u];
}

vec3 light_of_bytes(uint rgba)
{
	return vec3(light_of_byte(rgba & 255u), light_of_byte(rgba >> 8 & 255u),
		light_of_byte(rgba >> 16 & 255u));
}

float mask_depth(uint key)
{
	return uintBitsToFloat(key & 0xffffff00u);
}
