#version 310 es
/* Writes the strokes that were marked, as instances of quads. A group: a view. */
layout(local_size_x = 256) in;
layout(std430, binding = 6) writeonly buffer Strokes {
	uint strokes[]; /* x y along, half_width alpha q slope, slope, rgb and variant */
};
layout(location = 2) uniform uint capacity;
shared uint sums[256];
const uint WORDS = 10u;

uint before(uint thread, uint own)
{
	sums[thread] = own;
	memoryBarrierShared();
	barrier();
	for (uint far = 1u; far < THREADS; far *= 2u) {
		uint add = thread >= far ? sums[thread - far] : 0u;
		memoryBarrierShared();
		barrier();
		sums[thread] += add;
		memoryBarrierShared();
		barrier();
	}
	return sums[thread] - own;
}

float around_zero(uint point, uint salt)
{
	return 2.0 * chance(point, salt) - 1.0;
}

/* y is down, angles are counterclockwise */
vec2 turned_along(vec2 along, float half_px, float angle_deg)
{
	float a = angle_deg * (3.14159265 / 180.0), cosine = cos(a), sine = sin(a);
	return half_px * vec2(along.x * cosine + along.y * sine, along.y * cosine - along.x * sine);
}

uint colour_of(candidate c)
{
	uint rgba = looks[c.index].x;
	if (which.w == 0u || rgba >> 24 == 0u)
		return colour.x & 0xffffffu;
	float grey = float(lightness_of(rgba));
	vec3 own = vec3(uvec3(rgba, rgba >> 8, rgba >> 16) & 255u);
	uvec3 b = uvec3(clamp(grey + angle.z * (own - grey) + 0.5, 0.0, 255.0));
	return b.x | b.y << 8 | b.z << 16;
}

vec2 plane_slope(candidate c, vec3 normal, float around_px)
{
	float steepest = 0.5 / (c.depth_m * max(around_px, 1.0));
	float away = dot(normal, ray_of(c)) * c.depth_m * lens.x;
	return abs(away) > 1e-6 ? clamp(normal.xy / away, -steepest, steepest) : vec2(0.0);
}

void write_stroke(uint at, candidate c, float alpha, line edge, vec3 normal)
{
	vec2 slope = vec2(0.0), along;
	float half_px = shape.x / 2.0 * (1.0 + shape.w * around_zero(c.point, 1u));
	float off = angle.y * around_zero(c.point, 2u);
	if (edge.is_there && which.z != 0u) {
		half_px *= clamp(2.0 * edge.px_per_m * c.depth_m / lens.x, FORESHORTENED, 1.0);
		along = turned_along(edge.along, half_px, off);
		slope = edge.slope * edge.along;
	} else {
		along = turned_along(vec2(1.0, 0.0), half_px, angle.x + off);
		if (c.kind != UNDIRECTED && normal != vec3(0.0))
			slope = plane_slope(c, normal, half_px);
	}
	float word[9] = float[9](c.at.x, c.at.y, along.x, along.y, shape.y / 2.0, alpha, 1.0 / c.depth_m,
		slope.x, slope.y);
	for (uint k = 0u; k < 9u; k++)
		strokes[at * WORDS + k] = floatBitsToUint(word[k]);
	uint variant = uint(chance(c.point, 4u) * texels.z);
	strokes[at * WORDS + 9u] = colour_of(c) | variant << 24;
}

void main()
{
	uint n = first_view + gl_WorkGroupID.x, row = (n - layer_view) * MARKS;
	uint from = marks[row + THREADS];
	if (from == marks[row + MARKS + THREADS])
		return;
	uint thread = gl_LocalInvocationIndex, mark = marks[row + thread];
	uint at = from + before(thread, uint(bitCount(mark)));
	for (; mark != 0u && at < capacity; mark &= mark - 1u) {
		candidate c;
		line edge;
		vec3 normal;
		candidate_of(n, uint(findLSB(mark)) * THREADS + thread, c);
		float alpha = alpha_of(c, edge, normal);
		write_stroke(at++, c, alpha, edge, normal);
	}
}
