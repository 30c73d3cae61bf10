/* Eye-dome lighting (edl.h): how much light is left. rule: strength, radius in pixels. */
float depth_log2(ivec2 at)
{
	at = clamp(at, ivec2(0), ivec2(size.xy) - 1);
	return log2(min(mask_depth(texelFetch(mask_keys, at, 0).r), size.w));
}

float edl_shade(ivec2 at, vec2 rule)
{
	const vec2 ring[8] = vec2[8](vec2(1.0, 0.0), vec2(0.7071, 0.7071), vec2(0.0, 1.0),
		vec2(-0.7071, 0.7071), vec2(-1.0, 0.0), vec2(-0.7071, -0.7071), vec2(0.0, -1.0),
		vec2(0.7071, -0.7071));
	float here = depth_log2(at), sum = 0.0;
	for (int n = 0; n < 8; n++)
		sum += max(here - depth_log2(at + ivec2(roundEven(rule.y * ring[n]))), 0.0);
	return exp(-30.0 * rule.x * sum / 8.0);
}
