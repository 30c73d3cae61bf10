#version 310 es
/* How far the mask shows each link (profile-strokes.c). */
layout(local_size_x = 64) in;
layout(std430, binding = 3) writeonly buffer Shown {
	float shown[];
};
const float BEHIND_M = 0.08, BEHIND = 0.006;

float shows(vec2 at, float depth_m, float slack_m)
{
	ivec2 pixel = ivec2(clamp(at, vec2(0.0), size.xy - 1.0));
	return clamp(1.0 - (depth_m - mask_depth(texelFetch(mask_keys, pixel, 0).r)) / slack_m, 0.0, 1.0);
}

float shows_around(vec4 place)
{
	float slack_m = BEHIND_M + BEHIND * scale_m(place.z);
	vec2 at = place.xy - 0.5, whole = floor(at), part = at - whole;
	mat4 shown;
	for (int down = 0; down < 4; down++)
		for (int right = 0; right < 4; right++)
			shown[down][right] = shows(whole + vec2(float(right), float(down)) - 1.0, place.z, slack_m);
	mat4 beside = mat4(0.0);
	for (int down = 0; down < 4; down++)
		for (int right = 1; right < 3; right++)
			beside[down][right] = max(shown[down][right], max(shown[down][right - 1], shown[down][right + 1]));
	vec2 upper = max(beside[0].yz, max(beside[1].yz, beside[2].yz)),
	     lower = max(beside[1].yz, max(beside[2].yz, beside[3].yz));
	return (1.0 - part.y) * ((1.0 - part.x) * upper.x + part.x * upper.y) +
	       part.y * ((1.0 - part.x) * lower.x + part.x * lower.y);
}

void main()
{
	uint n = first_count.x + gl_GlobalInvocationID.x;
	if (n < first_count.y)
		shown[n] = shows_around(links[n].place);
}
