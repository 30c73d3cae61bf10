/* A Gaussian kernel; its diameter is five sigmas. pen: half_length, half_width, alpha, variant. */
vec2 ink_reach(float half_length, float half_width)
{
	return vec2(half_length);
}

float ink_alpha(vec2 own, vec4 pen)
{
	float sigma = 2.0 * pen.x / 5.0, away2 = dot(own, own);
	return away2 <= pen.x * pen.x ? exp(-away2 / (2.0 * sigma * sigma)) : 0.0;
}
