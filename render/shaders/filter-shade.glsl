#version 310 es
/* Shade in corners, or eye-dome lighting, into plane b; or plane a darkens pixels. by, of shade: radius_m, strength; then ways of sixteen
 * turns, two in one. Of the dome: strength, far_m, the ring's radius, how far points are apart in metres. whole, of the dome: its ring. */
const int CORNERS = 0, DOME = 1, RING = 12;
const float REACH_MOST_PX = 120.0, BEFORE_LEAST = 0.08;

float corners(ivec2 p)
{
	float here = depths[at_of(p)], radius_m = by[0].x, sum = 0.0;
	if (here >= FAR)
		return 1.0;
	float reach = min(radius_m * lens.x / scale_m(here), REACH_MOST_PX * bare.a);
	int turned = (p.x & 3) | (p.y & 3) << 2;
	for (int n = 0; n < RING; n++) {
		float reached = reach * (float(n * 5 % RING) + 1.0) / float(RING);
		int entry = turned * RING + n;
		vec4 ways = by[1 + (entry >> 1)];
		ivec2 on = ivec2(roundEven(((entry & 1) != 0 ? ways.zw : ways.xy) * reached));
		float both = 0.0;
		for (int side = -1; side <= 1; side += 2) {
			float there = depths[at_of(inside(p + side * on))];
			float before = there >= FAR ? -radius_m : here - there;
			if (before > radius_m)
				before = max(2.0 * radius_m - before, 0.0);
			both += max(before, -radius_m);
		}
		float part = both / (2.0 * radius_m) - BEFORE_LEAST * reached / max(reach, 1.0);
		sum += part > 0.0 ? min(part * 4.0, 1.0) : 0.0;
	}
	return exp(-1.6 * by[0].y * sum / float(RING));
}

float deep(ivec2 p)
{
	return log2(min(depths[at_of(inside(p))], by[0].y));
}

float dome(ivec2 p)
{
	vec2 than[4];
	float here = deep(p);
	for (int n = 0; n < 4; n++)
		than[n] = here - vec2(deep(p + whole[n].xy), deep(p + whole[n + 4].xy));
	return edl_light(by[0].x, than, depths[at_of(p)], by[0].w, by[0].z);
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (extent.z == CORNERS)
		b[at] = corners(p);
	else if (extent.z == DOME)
		b[at] = dome(p);
	else
		spare[at] = rgba_of(rgb_of(pixels[at]) * (depths[at] < FAR ? a[at] : 1.0));
}
