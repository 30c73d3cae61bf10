#version 310 es
/* What a stroke leaves in a pixel: factors that the blending multiplies, or of paint its sums, as band_ink has them. */
flat in vec4 pen_place;
flat in vec4 pen_body;
flat in vec3 pen_plane;
flat in vec3 pen_colour;
flat in vec4 pen_lay;
layout(location = 0) out vec4 ink;
layout(location = 1) out vec4 weight;
const uint INKED = 0u, COLOURED = 1u, PAINTED = 2u, LAID = 3u;
const float COVERS = 0.25;

/* 2^x, and what is between whole powers on straight lines. */
float power_of_two(float x)
{
	return uintBitsToFloat(uint((x + 127.0) * 8388608.0));
}

void lay(float thick, float behind)
{
	float cover = clamp((thick - pen_lay.y) * (1.0 / COVERS), 0.0, 1.0);
	if (!(cover > 0.0) || behind < pen_lay.z || behind > pen_lay.w)
		discard;
	float high = cover * power_of_two(pen_lay.x + paint_lay.y * thick);
	ink = vec4(high * pen_colour, 1.0 - cover);
	weight = vec4(high, high * thick, 0.0, 0.0);
}

void main()
{
	vec2 from = gl_FragCoord.xy - pen_place.xy;
	vec2 own = vec2(dot(from, pen_place.zw), from.y * pen_place.z - from.x * pen_place.w);
	float thick = ink_alpha(own, pen_body), alpha = thick * pen_body.z;
	float q = pen_plane.x + dot(from, pen_plane.yz);
	uint key = texelFetch(mask_keys, ivec2(gl_FragCoord.xy), 0).r;
	if (colour.y == LAID) {
		lay(thick, q * uintBitsToFloat(key));
		return;
	}
	if (!(alpha > 0.0) || q * uintBitsToFloat(key) < 1.0)
		discard;
	weight = vec4(alpha);
	if (colour.y == PAINTED)
		ink = vec4(alpha * pen_colour, 1.0 - alpha);
	else if (colour.y == COLOURED)
		ink = vec4(1.0 - alpha * (1.0 - pen_colour), 1.0);
	else
		ink = vec4(1.0 - alpha);
}
