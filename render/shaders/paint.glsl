/* Brush strokes: the rules of paint-need.h and paint-lanes.c. */
const float LEVEL_LEAST = 0.15, LEVEL_SURE = 0.45, FOLLOW_LEAST = 0.25, ACROSS_SURE = 1e-3;
const float PAINT_NARROWEST = 0.3, PAINT_DETAIL_SMALLER = 0.8, PAINT_LEAVES = 0.8;

/* What is the same for all copies of a point. */
struct brush {
	uint rgb_detail;
	float part, wave, aslant, shorter;
	vec3 along, up;
};

bool is_paint()
{
	return paint_size.x > 0.0;
}

bool is_flat_paint(candidate c, vec3 normal)
{
	return normal != vec3(0.0) && !is_leaf(c);
}

float zigzag(float x)
{
	return abs(fract(x) - 0.5) * 4.0 - 1.0;
}

float wave_at(candidate c)
{
	vec3 at = seen_place(c.at, c.depth_m);
	vec3 m = eye.xyz + at.x * turn[0].xyz + at.y * turn[1].xyz + at.z * turn[2].xyz;
	return 0.5 * zigzag(dot(m, vec3(0.11, 0.07, 0.05))) + 0.5 * zigzag(dot(m, vec3(-0.23, 0.31, 0.19)));
}

/* Twice their angles are mixed, for ways have no sign. */
vec3 mix_ways(vec3 plane, vec3 way, vec3 other, float part)
{
	vec3 up = cross(plane, way);
	vec2 at = vec2(dot(other, way), dot(other, up));
	vec2 twice = vec2(1.0 + part * (at.x * at.x - at.y * at.y - 1.0), part * 2.0 * at.x * at.y);
	float cosine = twice.x / max(length(twice), 1e-6);
	float across = sqrt(max(0.5 - 0.5 * cosine, 0.0));
	return sqrt(max(0.5 + 0.5 * cosine, 0.0)) * way + (twice.y < -ACROSS_SURE ? -across : across) * up;
}

vec3 level_way(vec3 plane)
{
	vec3 level = cross(vec3(turn[0].z, turn[1].z, turn[2].z), plane);
	float left = length(level), sure = clamp((left - LEVEL_LEAST) * (1.0 / (LEVEL_SURE - LEVEL_LEAST)), 0.0, 1.0);
	return mix_ways(plane, laid_flat(plane, vec3(1.0, 0.0, 0.0)).xyz, level / max(left, 1e-3), sure);
}

void find_brush(candidate c, vec3 normal, out brush p)
{
	bool is_flat = is_flat_paint(c, normal), lies = is_flat && paint_thick.w <= 0.0;
	vec3 ray = ray_of(c), plane = lies ? normal : normalize(ray);
	uint way = bends[2u * c.index + 1u];
	p.rgb_detail = bends[2u * c.index];
	uint detail = p.rgb_detail >> 24;
	p.part = paint_part[detail >> 2][detail & 3u];
	p.along = is_flat ? level_way(plane) : laid_flat(plane, cross(plane, seen_place(c.at, c.depth_m) - views[c.view].crown.xyz)).xyz;
	if ((way & 0xffffu) != NO_DIRECTION) {
		vec4 own = laid_flat(plane, turned(way));
		float clear = clamp((own.w - FOLLOW_LEAST) * (1.0 / FOLLOW_LEAST), 0.0, 1.0);
		p.along = mix_ways(plane, p.along, own.xyz, clear * paint_size.w);
	}
	p.up = cross(plane, p.along);
	p.wave = is_flat ? wave_at(c) : 0.0;
	float area = lies ? min(abs(dot(normal, ray)), 1.0) : 1.0;
	p.aslant = max(area, PAINT_NARROWEST);
	p.shorter = max(min(way_on_screen(c, p.along).z, 1.0), p.aslant);
}

/* As a part of the broadest; need: to a square metre, here. */
float size_of(brush p, float rank, float need)
{
	float fine = paint_size.y, detail = float(p.rgb_detail >> 24) * (1.0 / 255.0);
	float broadest = 1.0 - PAINT_DETAIL_SMALLER * paint_size.z * (1.0 - fine) * detail;
	float half_power = sqrt(need / p.part / rank);
	return min(max(fine * half_power * sqrt(half_power), fine), broadest);
}
