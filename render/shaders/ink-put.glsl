#version 310 es
/* Strokes into sums of ink (ink-sums.glsl). Some threads go through the pixels of a stroke: columns where it lies, rows where it stands,
 * and of each what is between its sides. finds_power: the highest power of two of paint alone, before its sums. */
layout(local_size_x = 256) in;
layout(std430, binding = 2) buffer Ink {
	uint ink[];
};
layout(std430, binding = 3) readonly buffer Strokes {
	uint strokes[];
};
layout(std430, binding = 4) readonly buffer Commands {
	uvec4 commands[64]; /* as choose-scan.glsl has them */
};
layout(location = 0) uniform uint layer;
layout(location = 1) uniform uint finds_power;
const uint THREADS = 256u, TOGETHER = 16u, WORDS = 10u;

int pixels_of_plane()
{
	return int(size.x) * int(size.y);
}

void add(int plane, int at, uint what)
{
	if (what != 0u)
		atomicAdd(ink[plane * pixels_of_plane() + at], what);
}

void put_paint(pen p, vec2 middle, int at)
{
	vec3 laid;
	if (!is_laid_at(p, middle, laid))
		return;
	/* With how much it covers: a touch of what lies high must not leave too few parts for what shows. */
	uint power = uint(max(int(floor(laid.y + log2(laid.x))) + POWER_ZERO, 0));
	if (finds_power != 0u) {
		if (ink[at] < power)
			atomicMax(ink[at], power);
		return;
	}
	float high = laid.x * power_of_two(clamp(laid.y - float(int(ink[at]) - POWER_ZERO), -32.0, 32.0));
	add(1, at, taken(1.0 - laid.x));
	for (int k = 0; k < 3; k++)
		add(2 + k, at, parts(high * p.colour[k]));
	add(5, at, parts(high));
	add(6, at, parts(high * laid.z));
}

void put(pen p, vec2 middle, int at)
{
	if (colour.y == LAID) {
		put_paint(p, middle, at);
		return;
	}
	float alpha = alpha_at(p, middle);
	if (!(alpha > 0.0))
		return;
	if (colour.y == INKED || colour.y == PAINTED)
		add(0, at, taken(1.0 - alpha));
	else if (colour.y == COLOURED)
		for (int k = 0; k < 3; k++)
			add(k, at, taken(left_by(p, alpha)[k]));
	else if (floatBitsToUint(1.0 - alpha) < ink[at])
		atomicMin(ink[at], floatBitsToUint(1.0 - alpha));
	if (colour.y == PAINTED) {
		for (int k = 0; k < 3; k++)
			add(1 + k, at, parts(alpha * p.colour[k]));
		add(4, at, parts(alpha));
	}
}

pen pen_at(uint n)
{
	float w[9];
	for (uint k = 0u; k < 9u; k++)
		w[k] = uintBitsToFloat(strokes[n * WORDS + k]);
	return pen_of(vec4(w[0], w[1], w[2], w[3]), vec4(w[4], w[5], w[6], w[7]), w[8], strokes[n * WORDS + 9u]);
}

void draw(pen p, uint thread)
{
	vec2 most = reach_of(p), along = p.place.zw;
	bool lies = abs(along.x) >= abs(along.y);
	ivec2 area = lies ? ivec2(size.xy) : ivec2(size.yx);
	vec2 middle = lies ? p.place.xy : p.place.yx, way = lies ? along : along.yx;
	float by_way = 1.0 / way.x, lean = way.y * by_way, half_side = most.y * abs(by_way);
	float half_long = abs(way.x) * most.x + abs(way.y) * most.y;
	int first = max(int(ceil(middle.x - half_long - 0.5)), 0);
	int end = min(int(floor(middle.x + half_long - 0.5)), area.x - 1) + 1;
	int wide = int(floor(2.0 * half_side)) + 1, columns = end - first;
	for (int k = int(thread); k < columns * wide; k += int(TOGETHER)) {
		int row = k / columns, x = first + k - row * columns;
		float dx = float(x) + 0.5 - middle.x;
		int y = int(ceil(middle.y + dx * lean - half_side - 0.5)) + row;
		if (y < 0 || y >= area.y)
			continue;
		ivec2 at = lies ? ivec2(x, y) : ivec2(y, x);
		put(p, vec2(at) + 0.5, at.y * int(size.x) + at.x);
	}
}

void main()
{
	uint together = gl_LocalInvocationIndex / TOGETHER, thread = gl_LocalInvocationIndex % TOGETHER;
	uint begin = gl_WorkGroupID.x * (THREADS / TOGETHER) + together, step = gl_NumWorkGroups.x * (THREADS / TOGETHER);
	for (uint n = begin; n < commands[layer].y; n += step)
		draw(pen_at(n), thread);
}
