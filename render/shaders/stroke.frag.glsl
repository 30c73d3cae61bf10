#version 310 es
/* What a stroke leaves in a pixel: factors that the blending multiplies, or of paint its sums, as band_ink has them. */
flat in vec4 pen_place;
flat in vec4 pen_body;
flat in vec3 pen_plane;
flat in vec3 pen_colour;
flat in vec4 pen_lay;
layout(location = 0) out vec4 ink;
layout(location = 1) out vec4 weight;
const uint INKED = 0u, STRONGEST = 1u, COVERING = 2u, COLOURED = 3u, PAINTED = 4u, LAID = 5u;
const float COVERS = 0.25;

/* 2^x, and what is between whole powers on straight lines. */
float power_of_two(float x)
{
	return uintBitsToFloat(uint((x + 127.0) * 8388608.0));
}

bool is_reached(float q, uint key)
{
	float behind = q * uintBitsToFloat(key);
	return behind >= pen_lay.z && behind <= pen_lay.w;
}

/* What is outside of the mask is empty. */
bool is_reached_there(float q, ivec2 at)
{
	bool is_in = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(size.xy)));
	return is_reached(q, is_in ? texelFetch(mask_keys, at, 0).r & 0xffffff00u : MASK_EMPTY);
}

/* At half the way to beyond a hole, or at all of it. */
bool is_reached_beside(float q, ivec2 at, ivec2 way)
{
	int far = int(paint_hole.x), half_way = (far + 1) / 2;
	return is_reached_there(q, at + half_way * way) || is_reached_there(q, at + far * way);
}

/* Where paint may be: on what it reaches, and on small holes in that. */
bool takes_paint(float q, ivec2 at)
{
	const ivec2 right = ivec2(1, 0), down = ivec2(0, 1);
	uint key = texelFetch(mask_keys, at, 0).r;
	if (is_reached(q, key) || key < MASK_EMPTY)
		return is_reached(q, key);
	return (is_reached_beside(q, at, -right) && is_reached_beside(q, at, right)) ||
	       (is_reached_beside(q, at, -down) && is_reached_beside(q, at, down));
}

void lay(float thick, float q)
{
	float cover = clamp((thick - pen_lay.y) * (1.0 / COVERS), 0.0, 1.0);
	if (!(cover > 0.0) || !takes_paint(q, ivec2(gl_FragCoord.xy)))
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
		lay(thick, q);
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
