#version 310 es
/* How far the mask shows each link (profile-strokes.c). */
layout(local_size_x = 64) in;
layout(std430, binding = 3) writeonly buffer Shown {
	float shown[];
};
const float BEHIND_M = 0.04, BEHIND = 0.004;

float shows(vec2 at, float depth_m, float slack_m)
{
	ivec2 pixel = ivec2(clamp(at, vec2(0.0), size.xy - 1.0));
	return clamp(1.0 - (depth_m - mask_depth(texelFetch(mask_keys, pixel, 0).r)) / slack_m, 0.0, 1.0);
}

float shows_around(vec4 place)
{
	float slack_m = BEHIND_M + BEHIND * scale_m(place.z);
	vec2 at = place.xy - 0.5, whole = floor(at), part = at - whole;
	vec2 upper = vec2(shows(whole, place.z, slack_m), shows(whole + vec2(1.0, 0.0), place.z, slack_m)),
	     lower = vec2(shows(whole + vec2(0.0, 1.0), place.z, slack_m), shows(whole + 1.0, place.z, slack_m));
	return (1.0 - part.y) * ((1.0 - part.x) * upper.x + part.x * upper.y) +
	       part.y * ((1.0 - part.x) * lower.x + part.x * lower.y);
}

void main()
{
	uint n = first_count.x + gl_GlobalInvocationID.x;
	if (n < first_count.y)
		shown[n] = shows_around(links[n].place);
}
