#version 310 es
/* Puts a layer's ink on the canvas, by multiplying it; of paint: what it adds, and in alpha what it leaves of the canvas. */
layout(location = 0) out vec4 canvas;
layout(binding = 3) uniform sampler2D ink_plane;
layout(binding = 4) uniform sampler2D weight_plane;
const uint INKED = 0u, COLOURED = 1u, PAINTED = 2u;

/* Ink lies thicker on what stands up, as much thicker as it lies thinner in the hollows. */
vec4 on_relief(vec4 bare)
{
	if (!(look.w > 0.0))
		return bare;
	vec4 cover = 1.0 - bare;
	return 1.0 - clamp(cover * (1.0 + 4.0 * look.w * relief_at(gl_FragCoord.xy) * bare), 0.0, 1.0);
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	vec4 ink = texelFetch(ink_plane, at, 0);
	if (colour.y == PAINTED) {
		float weight = texelFetch(weight_plane, at, 0).r, bare = on_relief(ink.aaaa).x;
		canvas = weight > 0.0 ? vec4((1.0 - bare) * ink.rgb / weight, bare) : vec4(0.0, 0.0, 0.0, 1.0);
	} else if (colour.y == COLOURED)
		canvas = vec4(on_relief(ink).rgb, 1.0);
	else
		canvas = vec4(ink_linear.rgb + (1.0 - ink_linear.rgb) * on_relief(ink.rrrr).r, 1.0);
}
