#version 310 es
/* Depth inpainting (depth-inpaint.h): the lightness before filters in plane a, 0..255, or made there; depths into plane b. by: threshold,
 * of 255. whole: radius. */
const int GREY = 0;

float grey_of(uint rgba)
{
	uvec3 rgb = uvec3(rgba, rgba >> 8, rgba >> 16) & 255u;
	return float((77u * rgb.r + 150u * rgb.g + 29u * rgb.b + 128u) >> 8);
}

float depth_around(ivec2 p)
{
	int radius = whole[0].x;
	ivec2 from = max(p - radius, ivec2(0)), end = min(p + radius + 1, area.xy);
	float sum = 0.0, count = 0.0;
	for (int y = from.y; y < end.y; y++)
		for (int x = from.x; x < end.x; x++) {
			ivec2 to = ivec2(x, y) - p;
			float there = depths[at_of(ivec2(x, y))];
			if (to.x * to.x + to.y * to.y > radius * radius || there >= FAR)
				continue;
			sum += there;
			count += 1.0;
		}
	return count > 0.0 ? sum / count : depths[at_of(p)];
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	/* Ink beside things is no part of them yet. */
	if (extent.z == GREY)
		a[at] = grey_of(depths[at] < FAR ? pixels[at] : bare_rgba());
	else
		b[at] = abs(grey_of(pixels[at]) - a[at]) <= by[0].x ? depths[at] : depth_around(p);
}
