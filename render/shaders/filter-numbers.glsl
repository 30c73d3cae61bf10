#version 310 es
/* Small passes from number to number: lightness of pixels into plane b; how many pixels of a block are of something, into b, and what
 * that says of it (filter_solidity), from a into b; plane a into b as it is. */
const int LIGHTNESS = 0, COUNT = 1, SOLID = 2, COPY = 3;
const int BLOCK = 4;
const float SOLID_NOT = 0.10, SOLID_ALL = 0.24;

float count_of(ivec2 p)
{
	ivec2 from = p * BLOCK, end = min(from + BLOCK, area.xy);
	int sum = 0;
	for (int y = from.y; y < end.y; y++)
		for (int x = from.x; x < end.x; x++)
			sum += depths[at_of(ivec2(x, y))] < FAR ? 1 : 0;
	return float(sum) / float((end.x - from.x) * (end.y - from.y));
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = p.y * extent.x + p.x;
	if (extent.z == LIGHTNESS)
		b[at] = lightness_of(pixels[at]);
	else if (extent.z == COUNT)
		b[at] = count_of(p);
	else if (extent.z == SOLID)
		b[at] = step_between(SOLID_NOT, SOLID_ALL, a[at]);
	else
		b[at] = a[at];
}
