#version 310 es
/* A sheet, as it was drawn, becomes a box of a picture for filters: pixels, depths as they were before the mask pushed them back, what each
 * pixel is of, how far it is from the focus. Or the last alone, of depths that are there. whole: width of the picture; 1: with normals and
 * segments; 1: with a focus; 1 + the leaf that all are of, 0: leaves are told. */
const int TAKE = 0;

layout(binding = 3) uniform sampler2D drawn;
layout(std430, binding = 4) readonly buffer Pushed {
	vec4 pushed[]; /* of each pipeline: offset_m, per; 1: the focus is on it (sheet-plan.h) */
};
layout(std430, binding = 5) readonly buffer Sums {
	int sums[]; /* as sheet-surface.glsl leaves them; leaves are in spare pixels */
};
layout(std430, binding = 6) readonly buffer Nearest {
	float nearest_m[];
};
layout(std430, binding = 7) writeonly buffer Surface {
	vec4 surface[];
};

float away_at(ivec2 p, uint key, float depth_m)
{
	/* What nothing is behind counts by where it is in the picture: as deep as the focus. */
	if (depth_m >= FAR)
		depth_m = max(focus.z, lens.w);
	return away_of(seen_place(vec2(p + area.zw) + 0.5, depth_m), key < MASK_EMPTY && pushed[key & 255u].z > 0.0);
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p), there = (p.y + area.w) * whole[0].x + p.x + area.z;
	uint key = texelFetch(mask_keys, p + area.zw, 0).r;
	if (extent.z == TAKE) {
		vec4 push = pushed[key & 255u];
		float depth_m = key < MASK_EMPTY ? (mask_depth(key) - push.x) / push.y : FAR;
		if (whole[0].y != 0) {
			vec3 n = vec3(float(sums[3 * there]), float(sums[3 * there + 1]), float(sums[3 * there + 2]));
			float reach = length(n);
			bool is_there = nearest_m[there] < FAR;
			int leaf = whole[0].w == 0 ? int(spare[there]) : is_there ? whole[0].w - 1 : 0;
			surface[at] = vec4(reach > 0.07 ? n / reach : vec3(0.0), float(leaf));
			if (key < MASK_EMPTY && is_there)
				depth_m = nearest_m[there];
		}
		depths[at] = depth_m;
		pixels[at] = rgba_of(texelFetch(drawn, p + area.zw, 0).rgb * 255.0);
	}
	if (whole[0].z != 0)
		away[at] = away_at(p, key, depths[at]);
}
