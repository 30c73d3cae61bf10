/* Even, with ends and sides that are soft over a pixel. */
vec2 ink_reach(float half_length, float half_width)
{
	return vec2(half_length, half_width) + 0.5;
}

float ink_alpha(vec2 own, vec4 pen)
{
	vec2 in_it = clamp(ink_reach(pen.x, pen.y) - abs(own), 0.0, 1.0);
	return in_it.x * in_it.y;
}
