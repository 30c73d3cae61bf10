#version 310 es
/* Small passes from number to number: lightness of pixels into plane b; how many pixels of a block are of something, into b, and what
 * that says of it (filter_solidity), from a into b; 1/depth that is calm along rows (filter_calm_depth), into b, and along columns too,
 * from a into b, as depth again. */
const int LIGHTNESS = 0, COUNT = 1, SOLID = 2, CALM_ACROSS = 3;
const int CALM_REACH = 3;
const float CALM_SAME = 0.02;
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

float by_depth(ivec2 p)
{
	int at = at_of(p);
	return extent.z != CALM_ACROSS ? a[at] : depths[at] < FAR ? 1.0 / depths[at] : 0.0;
}

float calm(ivec2 p, ivec2 on)
{
	float own = by_depth(p), sum = own, count = 1.0, most = CALM_SAME * own;
	for (int k = 1; k <= CALM_REACH; k++) {
		ivec2 before = p - k * on, behind = p + k * on;
		if (!is_in_area(before) || !is_in_area(behind))
			break;
		float one = by_depth(before), other = by_depth(behind);
		if (abs(one - own) < most && abs(other - own) < most) {
			sum += one + other;
			count += 2.0;
		}
	}
	return sum / count;
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
	else if (extent.z == CALM_ACROSS)
		b[at] = calm(p, ivec2(1, 0));
	else {
		float calmed = calm(p, ivec2(0, 1));
		b[at] = calmed > 0.0 ? 1.0 / calmed : FAR;
	}
}
