#version 310 es
/* Lines where depth, slant or segment change: edges are found, into b; what is alone is left out, from a into b; so is what is crowded, a
 * by its means b into d; they become as wide as lines, from a into b; then they are drawn, of a, wobbling by b and d. by: depth, cosine
 * of the bend or 2, opacity, wobble_px; colour. whole: radius; 1: segments. Plane d has normals and segments when edges are found. */
const int FIND = 0, LINK = 1, THIN = 2, WIDEN = 3;
const int BEYOND = 4, SIDE = 3;
const float LINKED_LEAST = 3.0, LINKED_ALL = 5.0, CROWD_SOME = 0.16, CROWD_ALL = 0.32;
BETWEEN(between_a, a)

/* -1 beyond the picture. */
float depth_on(ivec2 p)
{
	return is_in_area(p) ? depths[at_of(p)] : -1.0;
}

bool steps_down(ivec2 p, ivec2 way)
{
	float here = depths[at_of(p)], back = depth_on(p - 2 * way);
	float slope = back > 0.0 && back < FAR ? max(here - back, 0.0) / 2.0 : 0.0;
	for (int n = 1; n <= BEYOND; n++) {
		float there = depth_on(p + n * way);
		if (there < 0.0)
			return n > 1;
		if (there >= FAR)
			continue;
		if (by[0].x <= 0.0 || there - here - slope * float(n) <= by[0].x * here)
			return false;
	}
	return depth_on(p + way) >= 0.0;
}

/* The sum of the normals from the first on, as far as they are of the same surface. */
vec3 normals_of(ivec2 p, ivec2 way, int first)
{
	float last_m = depths[at_of(p)];
	vec3 sum = vec3(0.0);
	for (int n = first; n < first + SIDE; n++) {
		float here_m = depth_on(p + n * way);
		if (here_m < 0.0 || abs(here_m - last_m) > 0.02 * last_m)
			break;
		int at = 4 * at_of(p + n * way);
		sum += vec3(d[at], d[at + 1], d[at + 2]);
		last_m = here_m;
	}
	return sum;
}

bool bends(ivec2 p, ivec2 way)
{
	if (by[0].y > 1.5)
		return false;
	vec3 one = normals_of(p, -way, 0), other = normals_of(p, way, 1);
	float one2 = dot(one, one), other2 = dot(other, other);
	return one2 > 0.5 && other2 > 0.5 && dot(one, other) < by[0].y * sqrt(one2 * other2);
}

bool is_edge(ivec2 p)
{
	int at = at_of(p);
	float here = depths[at];
	if (here >= FAR)
		return false;
	for (int n = 0; n < 4; n++) {
		ivec2 way = (n & 1) == 0 ? ivec2(1 - n, 0) : ivec2(0, 2 - n);
		if (!is_in_area(p + way))
			continue;
		int other = at_of(p + way);
		if (steps_down(p, way))
			return true;
		if (depths[other] >= FAR)
			continue;
		bool is_mine = here < depths[other] || (here == depths[other] && n < 2);
		if (is_mine && bends(p, way))
			return true;
		float leaf = d[4 * at + 3], other_leaf = d[4 * other + 3];
		if (whole[0].y != 0 && is_mine && leaf > 0.0 && other_leaf > 0.0 && leaf != other_leaf)
			return true;
	}
	return false;
}

float linked(ivec2 p)
{
	float sum = 0.0;
	if (!(a[at_of(p)] > 0.0))
		return 0.0;
	ivec2 from = max(p - 2, ivec2(0)), end = min(p + 3, area.xy);
	for (int y = from.y; y < end.y; y++)
		for (int x = from.x; x < end.x; x++)
			sum += a[at_of(ivec2(x, y))] > 0.0 ? 1.0 : 0.0;
	return a[at_of(p)] * step_between(LINKED_LEAST, LINKED_ALL, sum);
}

float widened(ivec2 p)
{
	int radius = whole[0].x;
	float most = 0.0;
	for (int dy = -radius; dy <= radius; dy++)
		for (int dx = -radius; dx <= radius; dx++) {
			ivec2 there = p + ivec2(dx, dy);
			if (dx * dx + dy * dy <= radius * radius + radius && is_in_area(there))
				most = max(most, a[at_of(there)]);
		}
	return most;
}

void draw(ivec2 p)
{
	int at = at_of(p);
	float line = a[at];
	if (by[0].w > 0.0)
		line = between_a(area.xy, vec2(p) + 2.0 * by[0].w * vec2(b[at], d[at]));
	spare[at] = rgba_of(mix(rgb_of(pixels[at]), by[1].rgb, line * by[0].z * weight_at(at)));
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (extent.z == FIND)
		b[at] = is_edge(p) ? solid_at(p) : 0.0;
	else if (extent.z == LINK)
		b[at] = linked(p);
	else if (extent.z == THIN)
		d[at] = a[at] * step_between(CROWD_ALL, CROWD_SOME, b[at]);
	else if (extent.z == WIDEN)
		b[at] = widened(p);
	else
		draw(p);
}
