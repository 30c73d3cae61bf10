/* Eye-dome lighting (edl.h): how much light is left. rule: strength, radius in pixels, how far points are apart in metres. */
float depth_log2(ivec2 at)
{
	at = clamp(at, ivec2(0), ivec2(size.xy) - 1);
	return log2(min(mask_depth(texelFetch(mask_keys, at, 0).r), size.w));
}

float edl_shade(ivec2 at, vec3 rule)
{
	const vec2 ring[4] = vec2[4](
		vec2(1.0, 0.0), vec2(0.7071, 0.7071), vec2(0.0, 1.0), vec2(-0.7071, 0.7071));
	float here = depth_log2(at);
	vec2 than[4];
	for (int n = 0; n < 4; n++) {
		ivec2 on = ivec2(roundEven(rule.y * ring[n]));
		than[n] = here - vec2(depth_log2(at + on), depth_log2(at - on));
	}
	return edl_light(rule.x, than, mask_depth(texelFetch(mask_keys, at, 0).r), rule.z, rule.y);
}
