#version 310 es
/* What lies under strokes that are drawn over what filters made: that, on the paper's grain where nothing is, and fading away from the
 * focus. */
layout(location = 0) out vec4 canvas;
layout(std430, binding = 2) readonly buffer Picture {
	uint picture[];
};

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	uint key = texelFetch(mask_keys, at, 0).r;
	bool is_bare = key >= MASK_EMPTY;
	float up = 1.0 + 0.5 * paper.a * relief_at(gl_FragCoord.xy);
	vec3 colour = light_of_bytes(picture[at.y * int(size.x) + at.x]);
	if (is_bare)
		colour = min(colour * up, 1.0);
	if (focus.w > 0.0) {
		/* Beside things filters may have drawn: as deep as the focus. */
		float depth_m = is_bare ? max(focus.z, lens.w) : mask_depth(key);
		bool is_focus = !is_bare && edl[key & 255u].z > 0.0;
		colour += focus.w * away_of(seen_place(gl_FragCoord.xy, depth_m), is_focus) * (min(paper.rgb * up, 1.0) - colour);
	}
	canvas = vec4(colour, 1.0);
}
