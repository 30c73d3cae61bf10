#version 310 es
/* Gaps that are closed, depths and all: depths into plane b; plane c tells how much of each block of pixels is
 * something. whole: radius; asked are pixels so far apart. */
const int SIDES_LEAST = 6, BLOCK = 4;

/* Most of what is empty has nothing near. */
bool is_near(ivec2 p, int radius)
{
	ivec2 blocks = (area.xy + BLOCK - 1) / BLOCK;
	ivec2 from = max(p - radius, ivec2(0)) / BLOCK, end = min((p + radius) / BLOCK, blocks - 1);
	for (int y = from.y; y <= end.y; y++)
		for (int x = from.x; x <= end.x; x++)
			if (c[y * blocks.x + x] > 0.0)
				return true;
	return false;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p), radius = whole[0].x, apart = whole[0].y, reach = radius / apart * apart;
	spare[at] = pixels[at];
	b[at] = depths[at];
	if (depths[at] < FAR || !is_near(p, radius))
		return;
	vec4 sum = vec4(0.0);
	float depth_m = 0.0;
	uint sides = 0u;
	for (int dy = -reach; dy <= reach; dy += apart)
		for (int dx = -reach; dx <= reach; dx += apart) {
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
