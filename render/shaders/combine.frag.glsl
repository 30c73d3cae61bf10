#version 310 es
/* Puts a layer's ink on the canvas, by multiplying it; of paint: what it adds, and in alpha what it leaves of the canvas. */
layout(location = 0) out vec4 canvas;

/* Ink lies thicker on what stands up, as much thicker as it lies thinner in the hollows. */
vec4 on_relief(vec4 bare)
{
	if (!(look.w > 0.0))
		return bare;
	vec4 cover = 1.0 - bare;
	return 1.0 - clamp(cover * (1.0 + 4.0 * look.w * relief_at(gl_FragCoord.xy) * bare), 0.0, 1.0);
}

float thickness_at(ivec2 at)
{
	vec2 sum = weight_at(at);
	return sum.x > 0.0 ? sum.y / sum.x * (1.0 - ink_at(at).a) : 0.0;
}

/* Beside the picture there is none; above and below it is as on its border. */
float thickness_beside(ivec2 at)
{
	return at.x >= 0 && at.x < int(size.x) ? thickness_at(at) : 0.0;
}

/* What light does to paint: a factor, and what it adds (draw-lanes.c). */
vec2 light_paint(ivec2 at)
{
	const float SHADE = 0.6;
	int last = int(size.y) - 1;
	vec2 n = paint_thick.x *
		 vec2(thickness_beside(at - ivec2(1, 0)) - thickness_beside(at + ivec2(1, 0)),
			 thickness_at(ivec2(at.x, max(at.y - 1, 0))) - thickness_at(ivec2(at.x, min(at.y + 1, last))));
	float unit = 1.0 / sqrt(dot(n, n) + 1.0);
	float facing = dot(vec3(n, 1.0), paint_light.xyz) * unit;
	float glint = max(2.0 * facing * unit - paint_light.z, 0.0);
	glint *= glint;
	glint *= glint;
	glint *= glint;
	return vec2(1.0 + SHADE * (facing - paint_light.z), paint_thick.y * glint * glint);
}

/* ---- gaps between strokes (paint-gaps.h) ---- */

const int GAP_PLACES = 4;
const float GAP_BARE = 0.04, GAP_FULL = 0.98, GAP_DEPTH = 0.05;

/* Adds the paint at a place beside the gap to a sum: colours, and how much they cover of it. */
vec4 looked_at(ivec2 at, float depth_m, vec4 sum)
{
	if (at.x < 0 || at.x >= int(size.x))
		return sum;
	float there_m = uintBitsToFloat(texelFetch(mask_keys, at, 0).r), high = weight_at(at).x;
	if (!(high > 0.0) || !(abs(there_m - depth_m) <= (GAP_DEPTH + paint_lay.z - 1.0) * depth_m))
		return sum;
	vec4 ink = ink_at(at);
	float cover = (1.0 - sum.a) * (1.0 - ink.a);
	return sum + vec4(cover / high * ink.rgb, cover);
}

/* What a gap is filled with, and how much. */
vec4 gap_fill(ivec2 at, float bare)
{
	uint key = texelFetch(mask_keys, at, 0).r;
	int gap_px = int(paint_hole.w);
	if (gap_px == 0 || key >= MASK_EMPTY || (key & 255u) != paint_of.x || !(bare > GAP_BARE))
		return vec4(0.0);
	vec4 left = vec4(0.0), right = vec4(0.0);
	for (int n = 1; n <= GAP_PLACES && left.a + right.a < 2.0 * GAP_FULL; n++) {
		ivec2 away = ivec2((n * gap_px + GAP_PLACES - 1) / GAP_PLACES, 0);
		left = looked_at(at - away, uintBitsToFloat(key), left);
		right = looked_at(at + away, uintBitsToFloat(key), right);
	}
	vec4 both = left + right;
	return vec4(both.rgb / max(both.a, 1e-6), min(both.a, 1.0));
}

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	vec4 ink = ink_at(at);
	if (colour.y == LAID) {
		float high = weight_at(at).x, bare = on_relief(ink.aaaa).x;
		vec2 by = light_paint(at);
		vec4 gap = gap_fill(at, ink.a);
		vec3 paint = high > 0.0 ? ink.rgb / high * by.x + by.y : vec3(0.0);
		canvas = vec4((1.0 - bare) * paint + bare * gap.a * gap.rgb, bare * (1.0 - gap.a));
	} else if (colour.y == PAINTED) {
		float weight = weight_at(at).x, bare = on_relief(ink.aaaa).x;
		canvas = weight > 0.0 ? vec4((1.0 - bare) * ink.rgb / weight, bare) : vec4(0.0, 0.0, 0.0, 1.0);
	} else if (colour.y == COVERING) {
		float bare = on_relief(ink.rrrr).r;
		canvas = vec4((1.0 - bare) * ink_linear.rgb, bare);
	} else if (colour.y == COLOURED)
		canvas = vec4(on_relief(ink).rgb, 1.0);
	else
		canvas = vec4(ink_linear.rgb + (1.0 - ink_linear.rgb) * on_relief(ink.rrrr).r, 1.0);
}
