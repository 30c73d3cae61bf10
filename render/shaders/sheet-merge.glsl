#version 310 es
/* How sheets become one picture (draw-sheets.c). Spare pixels and away are the whole picture's, whose width is in whole[0]: colours and
 * depths. by whole[0]: enum composite_by; 1: what covers only in part is kept apart; 1: with normals and segments. */
const int BEGIN = 0, MERGE = 1;
const int INPAINTED = 0, LAYERS = 2;
const int COVERS = 80; /* SHEET_COVERS */

layout(std430, binding = 4) readonly buffer Compared {
	float compared[]; /* depths */
};
layout(std430, binding = 5) buffer Soft {
	uvec2 soft[]; /* rgb and how much it covers; bits of its depth */
};
layout(std430, binding = 6) readonly buffer Surface {
	vec4 surface[];
};
layout(std430, binding = 7) writeonly buffer SurfaceOfAll {
	vec4 surface_of_all[];
};

ivec3 ints_of(uint rgba)
{
	return ivec3(uvec3(rgba, rgba >> 8, rgba >> 16) & 255u);
}

int change_of(uint rgba)
{
	ivec3 change = abs(ints_of(rgba) - ints_of(bare_rgba()));
	return max(max(change.r, change.g), change.b);
}

/* Towards 0, whatever the sign. */
ivec3 divided(ivec3 x, int by_what)
{
	return sign(x) * (abs(x) / by_what);
}

void put_soft(int at, int to)
{
	int change = change_of(pixels[at]);
	if (change == 0 || compared[at] >= uintBitsToFloat(soft[to].y))
		return;
	ivec3 paper_rgb = ints_of(bare_rgba());
	uvec3 full = uvec3(clamp(paper_rgb + divided((ints_of(pixels[at]) - paper_rgb) * COVERS, change), 0, 255));
	soft[to] = uvec2(full.r | full.g << 8 | full.b << 16 | uint(change * 255 / COVERS) << 24,
		floatBitsToUint(compared[at]));
}

void merge(int at, int to)
{
	bool has_ink = change_of(pixels[at]) > 0, is_far = compared[at] >= FAR, shows;
	if (whole[0].z != 0 && !is_far && depths[at] >= FAR && change_of(pixels[at]) < COVERS) {
		put_soft(at, to);
		return;
	}
	if (whole[0].y == LAYERS)
		shows = !is_far || has_ink;
	else if (is_far)
		shows = has_ink && away[to] >= FAR;
	else
		shows = compared[at] < away[to];
	if (!shows)
		return;
	spare[to] = pixels[at] | OPAQUE;
	away[to] = compared[at];
	if (whole[0].w != 0)
		surface_of_all[to] = surface[at];
}

/* What covers only in part comes over what is behind it. */
void blend(int to)
{
	float depth_m = uintBitsToFloat(soft[to].y);
	if (!(depth_m < away[to]))
		return;
	ivec3 below = ints_of(spare[to]);
	ivec3 change = (ints_of(soft[to].x) - below) * int(soft[to].x >> 24);
	uvec3 rgb = uvec3(below + divided(change + ivec3(127) * sign(change), 255));
	spare[to] = rgb.r | rgb.g << 8 | rgb.b << 16 | OPAQUE;
	if (away[to] >= FAR)
		away[to] = depth_m;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int to = (p.y + area.w) * whole[0].x + p.x + area.z;
	if (extent.z == MERGE) {
		merge(at_of(p), to);
	} else if (extent.z == BEGIN) {
		spare[to] = bare_rgba();
		away[to] = FAR;
		if (whole[0].z != 0)
			soft[to] = uvec2(0u, floatBitsToUint(FAR));
		if (whole[0].w != 0)
			surface_of_all[to] = vec4(0.0);
	} else
		blend(to);
}
