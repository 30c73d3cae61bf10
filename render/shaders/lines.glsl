/* Even, with ends and sides that are soft over a pixel. */
vec2 ink_reach(float half_length, float half_width)
{
	return vec2(half_length, half_width) + 0.5;
}

/* Those that are thinner than a pixel would be too strong by that. */
vec2 thinness(vec2 half_size)
{
	vec2 soft = half_size + 0.5;
	return mix(vec2(1.0), 2.0 * half_size / (soft * soft), lessThan(half_size, vec2(0.5)));
}

float ink_alpha(vec2 own, vec4 pen)
{
	vec2 in_it = clamp(ink_reach(pen.x, pen.y) - abs(own), 0.0, 1.0);
	vec2 strength = thinness(pen.xy);
	return in_it.x * in_it.y * strength.x * strength.y;
}
