#version 310 es
/* What a stroke leaves in a pixel: factors that the blending multiplies, or of paint its sums, as band_ink has them. */
flat in vec4 pen_place;
flat in vec4 pen_body;
flat in vec3 pen_plane;
flat in vec3 pen_colour;
layout(location = 0) out vec4 ink;
layout(location = 1) out vec4 weight;
const uint INKED = 0u, COLOURED = 1u, PAINTED = 2u;

void main()
{
	vec2 from = gl_FragCoord.xy - pen_place.xy;
	vec2 own = vec2(dot(from, pen_place.zw), from.y * pen_place.z - from.x * pen_place.w);
	float alpha = ink_alpha(own, pen_body) * pen_body.z;
	float q = pen_plane.x + dot(from, pen_plane.yz);
	uint key = texelFetch(mask_keys, ivec2(gl_FragCoord.xy), 0).r;
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
