#version 310 es
/* Lines where depth, slant or segment change (filter-edges.c): edges are found, into b, by normals and segments in d; b becomes the most around
 * each pixel of a; lines are those of a that are straight by what is around them in b, into d; they become as wide as lines, from a into b;
 * then they are drawn, of a, wobbling by b and d. by: depth, cosine of bends that begin to be lines or 2, opacity, wobble_px; colour, cosine of
 * bends that are; straightness that begins, and is; EDGES_ONE_SIDE, how far points
 * are apart in metres. whole: radius, 1: segments; then places on straight lines, two in one. */
const int FIND = 0, SPREAD = 1, LINK = 2, WIDEN = 3;
const int BEYOND = 4, SIDE = 4, WAYS = 8, REACH = 7;
const float SLOPE_MOST = 0.05, STEP_SOME = 0.7, STEP_ALL = 1.1;
BETWEEN(between_a, a)

/* -1 beyond the picture. */
float depth_on(ivec2 p)
{
	return is_in_area(p) ? depths[at_of(p)] : -1.0;
}

/* How much of 1/depth what is seen aslant changes by between two points. */
float step_of_points(ivec2 p)
{
	float here_m = depths[at_of(p)], slant = 0.0;
	for (int n = 0; n < 2; n++) {
		ivec2 on = ivec2(2 - 2 * n, 2 * n);
		float before = depth_on(p - on), behind = depth_on(p + on);
		if (before > 0.0 && before < FAR && behind > 0.0 && behind < FAR)
			slant = max(slant, min(abs(1.0 / here_m - 1.0 / before), abs(1.0 / here_m - 1.0 / behind)));
	}
	return slant / 2.0 * by[2].w * lens.x / scale_m(here_m);
}

float steps_down(ivec2 p, ivec2 way, float no_step)
{
	float here = 1.0 / depths[at_of(p)], back = depth_on(p - 2 * way), slope = 0.0, least = 1.0;
	if (back > 0.0 && back < FAR)
		slope = clamp((here - 1.0 / back) / 2.0, -SLOPE_MOST * here, SLOPE_MOST * here);
	for (int n = 1; n <= BEYOND; n++) {
		float there = depth_on(p + n * way);
		if (there < 0.0)
			return n > 1 ? least : 0.0;
		if (there >= FAR)
			continue;
		if (by[0].x <= 0.0)
			return 0.0;
		float over = (here + slope * float(n) - no_step) * there - 1.0;
		least = min(least, step_between(STEP_SOME * by[0].x, STEP_ALL * by[0].x, over));
	}
	return least;
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

float bends(ivec2 p, ivec2 way)
{
	if (by[0].y > 1.5)
		return 0.0;
	vec3 one = normals_of(p, -way, 0), other = normals_of(p, way, 1);
	float one2 = dot(one, one), other2 = dot(other, other);
	if (!(one2 > 0.5 && other2 > 0.5))
		return 0.0;
	return step_between(by[0].y, by[1].w, dot(one, other) / sqrt(one2 * other2));
}

float edge_at(ivec2 p)
{
	int at = at_of(p);
	float here = depths[at], most = 0.0;
	if (here >= FAR)
		return 0.0;
	float no_step = step_of_points(p);
	for (int n = 0; n < 4 && most < 1.0; n++) {
		ivec2 way = (n & 1) == 0 ? ivec2(1 - n, 0) : ivec2(0, 2 - n);
		if (!is_in_area(p + way))
			continue;
		int other = at_of(p + way);
		most = max(most, steps_down(p, way, no_step));
		if (depths[other] >= FAR)
			continue;
		bool is_mine = here < depths[other] || (here == depths[other] && n < 2);
		if (is_mine && most < 1.0)
			most = max(most, bends(p, way));
		float leaf = d[4 * at + 3], other_leaf = d[4 * other + 3];
		if (whole[0].y != 0 && is_mine && leaf > 0.0 && other_leaf > 0.0 && leaf != other_leaf)
			most = 1.0;
	}
	return most;
}

float most_around(ivec2 p)
{
	float most = 0.0;
	for (int y = max(p.y - 1, 0); y <= min(p.y + 1, area.y - 1); y++)
		for (int x = max(p.x - 1, 0); x <= min(p.x + 1, area.x - 1); x++)
			most = max(most, a[at_of(ivec2(x, y))]);
	return most;
}

/* How much more there is of edges along the straight line of the most than along all of them. */
float straightness_at(ivec2 p)
{
	float best = 0.0, together = 0.0;
	for (int w = 0; w < WAYS; w++) {
		float one = 0.0, other = 0.0;
		for (int n = 0; n < REACH; n++) {
			int entry = w * REACH + n;
			ivec4 both = whole[1 + (entry >> 1)];
			ivec2 on = (entry & 1) != 0 ? both.zw : both.xy;
			one += b[at_of(inside(p - on))];
			other += b[at_of(inside(p + on))];
		}
		float sum = max(one + other, by[2].z * max(one, other));
		best = max(best, sum);
		together += sum;
	}
	return (best - together / float(WAYS)) / float(2 * REACH);
}

float linked(ivec2 p)
{
	float found = a[at_of(p)];
	return found > 0.0 ? found * step_between(by[2].x, by[2].y, straightness_at(p)) : 0.0;
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
	if (extent.z == FIND) {
		float edge = edge_at(p);
		b[at] = edge > 0.0 ? edge * solid_at(p) : 0.0;
	} else if (extent.z == SPREAD)
		b[at] = most_around(p);
	else if (extent.z == LINK)
		d[at] = linked(p);
	else if (extent.z == WIDEN)
		b[at] = widened(p);
	else
		draw(p);
}
