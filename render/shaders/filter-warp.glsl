#version 310 es
/* Everything sways: colours, and depths into plane b; then other numbers, from plane a into b, so many of each pixel. by: wave, way;
 * amplitude, phase. whole: how many. */
const int COLOURS = 0;

bool is_border(vec2 p)
{
	ivec2 low = ivec2(clamp(p, vec2(0.0), vec2(area.xy - 1))), high = min(low + 1, area.xy - 1);
	int there = (depths[at_of(low)] < FAR ? 1 : 0) + (depths[at_of(ivec2(high.x, low.y))] < FAR ? 1 : 0) +
		    (depths[at_of(ivec2(low.x, high.y))] < FAR ? 1 : 0) + (depths[at_of(high)] < FAR ? 1 : 0);
	return there != 0 && there < 4;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	float sway = by[1].x * sin(dot(vec2(p + area.zw + window.xy), by[0].xy) + by[1].y);
	vec2 from = vec2(p) - sway * by[0].zw;
	int near = at_of(ivec2(clamp(from + 0.5, vec2(0.0), vec2(area.xy - 1))));
	if (extent.z == COLOURS) {
		b[at] = depths[near];
		spare[at] = is_border(from) ? pixels[near] : rgba_of(colour_between(from));
		return;
	}
	for (int k = 0; k < whole[0].x; k++)
		b[at * whole[0].x + k] = a[near * whole[0].x + k];
}
