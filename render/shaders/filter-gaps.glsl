#version 310 es
/* Gaps that are closed, depths and all: depths into plane b. whole: radius. */
const int SIDES_LEAST = 6;

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p), radius = whole[0].x;
	spare[at] = pixels[at];
	b[at] = depths[at];
	if (depths[at] < FAR)
		return;
	vec4 sum = vec4(0.0);
	float depth_m = 0.0;
	uint sides = 0u;
	for (int dy = -radius; dy <= radius; dy++)
		for (int dx = -radius; dx <= radius; dx++) {
			ivec2 there = p + ivec2(dx, dy);
			int away2 = dx * dx + dy * dy;
			if (away2 == 0 || away2 > radius * radius || !is_in_area(there) || depths[at_of(there)] >= FAR)
				continue;
			float weight = 1.0 / float(away2);
			sum += vec4(rgb_of(pixels[at_of(there)]), 1.0) * weight;
			depth_m += weight * depths[at_of(there)];
			sides |= 1u << ((dx > 0 ? 1 : 0) | (dy > 0 ? 2 : 0) | (abs(dx) > abs(dy) ? 4 : 0));
		}
	if (bitCount(sides) < SIDES_LEAST)
		return;
	spare[at] = rgba_of(sum.rgb / sum.a);
	b[at] = depth_m / sum.a;
}
