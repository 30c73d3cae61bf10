/* Hatching: the rules of hatch-need.h and hatch-lanes.c. */
layout(std430, binding = 7) readonly buffer Bends {
	uint bends[]; /* k1 and k2 of two points (scene-bend.h) */
};
/* By lightness and depth: colour and chance; strokes wanted to a square pixel. */
layout(binding = 6) uniform sampler2D xtoon_colours;
layout(binding = 7) uniform sampler2D xtoon_wanted;

const float WAY_LEAST = 0.1, BENT_BOTH_WAYS = 1.1, BENT_LEAST = 0.3, EDGE_POINTS = 4.0, FLAT_LEAST = 0.5;
const float HATCH_SHORTEST = 0.35, CROSS_FADE = 0.25, SHORTEST_SEEN = 0.12, HATCH_FOOT = 0.08, HATCH_FACING = 0.33, HATCH_LEAVES = 0.92;
const float SCREEN_SLANT = 0.05;
const uint FOLLOWS_CURVATURE = 1u, FOLLOWS_SCREEN = 2u;
const uint SALT_CROSS = 65536u, SALT_PENCIL = 65537u, XTOON = 1u, BLENDED = 3u;

struct hatch {
	ivec2 shade;
	float chance, larger;
	vec3 way[2];
	vec2 bent;
};

float shine_of(candidate c, vec3 normal)
{
	vec3 ray = ray_of(c);
	float lit = dot(normal, light_from.xyz), along = dot(normal, ray);
	float towards = (dot(ray, light_from.xyz) - 2.0 * lit * along) / length(ray);
	return lit > 0.0 && towards > 0.0 ? hatch_light.x * pow(towards, hatch_light.y) : 0.0;
}

float brightness_of(candidate c, vec3 normal)
{
	uint rgba = looks[c.index].x;
	float own = float(lightness_of(rgba)) * (1.0 / 255.0);
	own += hatch_tone.y * (clamp((own - hatch_tone.z) * hatch_tone.w, 0.0, 1.0) - own);
	if (rgba >> 24 == 0u)
		own = 1.0;
	float bright = (1.0 - hatch_tone.x * (1.0 - own)) * lit_of(normal);
	if (hatch_light.x > 0.0 && light_from.w > 0.0)
		bright += light_from.w * shine_of(c, normal);
	return clamp(bright, 0.0, 1.0);
}

/* 0..1 on the way from near to far. */
float depth_part(float depth_m)
{
	return clamp((depth_m - rays.w - hatch_light.z) * hatch_light.w, 0.0, 1.0);
}

/* Into the plane; unit, and what was left of its length. */
vec4 laid_flat(vec3 normal, vec3 v)
{
	v -= dot(normal, v) * normal;
	float left = length(v);
	return vec4(v / max(left, 1e-6), left);
}

vec3 uniform_way(vec3 plane)
{
	vec4 way = laid_flat(plane, to_camera(hatch_way.xyz));
	if (way.w >= WAY_LEAST)
		return way.xyz;
	return laid_flat(plane, to_camera(vec3(1.0, 1.0, 0.0))).xyz;
}

float bend_of(uint code)
{
	float step = float(code & 127u);
	float size = step == 0.0 ? 0.0 : exp2((step - 1.0) * (1.0 / 9.0)) * (1.0 / 16.0);
	return code > 127u ? -size : size;
}

/* Leaves are not. */
bool is_flat_here(candidate c, vec3 normal)
{
	return normal != vec3(0.0) && points[c.index].z >> 24 != UNDIRECTED;
}

void find_ways(candidate c, vec3 normal, inout hatch h)
{
	vec3 plane = is_flat_here(c, normal) ? normal : normalize(ray_of(c));
	h.bent = vec2(0.0);
	if (hatch_which.y == FOLLOWS_SCREEN) {
		vec3 ray = ray_of(c);
		float along = dot(plane, ray);
		along = along < 0.0 ? min(along, -SCREEN_SLANT) : max(along, SCREEN_SLANT);
		h.way[0] = ray * (-plane.x / along) + vec3(1.0, 0.0, 0.0);
		h.way[1] = ray * (-plane.y / along) + vec3(0.0, 1.0, 0.0);
		return;
	}
	h.way[0] = uniform_way(plane);
	if (hatch_way.w > 1.5) {
		uint two = bends[c.index >> 1] >> ((c.index & 1u) * 16u), bits = looks[c.index].y;
		vec2 k = vec2(bend_of(two & 255u), bend_of(two >> 8 & 255u));
		bool some = (bits & 0xffffu) != NO_DIRECTION;
		bool is_edge = points[c.index].z >> 24 >= UNDIRECTED;
		float sharp = (1.0 / EDGE_POINTS) / c.spacing_m;
		vec4 flat_axis = laid_flat(plane, turned(bits));
		vec3 axis = flat_axis.xyz;
		if (hatch_which.y == FOLLOWS_CURVATURE && some && !is_edge && flat_axis.w > FLAT_LEAST) {
			float bent = abs(k.x), clear = clamp((bent - BENT_BOTH_WAYS * abs(k.y)) / max(0.5 * bent, 1e-6), 0.0, 1.0);
			clear *= clamp((bent - BENT_LEAST) * (1.0 / BENT_LEAST), 0.0, 1.0);
			vec3 towards = dot(h.way[0], axis) < 0.0 ? -axis : axis;
			h.way[0] += clear * (towards - h.way[0]);
			h.way[0] /= max(length(h.way[0]), 1e-3);
		}
		float cosine = dot(axis, h.way[0]), part = min(cosine * cosine, 1.0);
		if (is_edge)
			k = vec2(some ? 0.0 : sharp, sharp);
		h.bent = abs(some ? vec2(mix(k.y, k.x, part), mix(k.x, k.y, part)) : k.xx);
	}
	h.way[1] = cross(plane, h.way[0]);
}

/* What is left of the length of a way on the screen, and which way that is. */
vec3 way_on_screen(candidate c, vec3 way)
{
	vec2 over = way.xy - ray_of(c).xy * way.z;
	float part = length(over);
	return vec3(over / max(part, 1e-3), part);
}

float straight_part(float bent, float length_px, float depth_m)
{
	return 1.0 / (1.0 + hatch_shape.z * bent * length_px * scale_m(depth_m) * (1.0 / lens.x));
}

/* Points that give strokes, to a square pixel. */
float hatch_wanted(candidate c, vec3 normal, out hatch h)
{
	float away = depth_part(c.depth_m);
	h.shade = ivec2(int(brightness_of(c, normal) * 255.0 + 0.5), int(away * float(hatch_which.x - 1u) + 0.5));
	h.chance = texelFetch(xtoon_colours, h.shade, 0).a;
	h.larger = 1.0 + hatch_shape.w * away;
	find_ways(c, normal, h);
	float second = h.chance * hatch_shape.x, length_px = shape.x * h.larger;
	vec2 part = vec2(min(way_on_screen(c, h.way[0]).z, 1.0) * straight_part(h.bent.x, length_px, c.depth_m),
		min(way_on_screen(c, h.way[1]).z, 1.0) * straight_part(h.bent.y, length_px, c.depth_m));
	float shorter = max((part.x + second * part.y) / (1.0 + second), HATCH_SHORTEST);
	return texelFetch(xtoon_wanted, h.shade, 0).r * (is_flat_here(c, normal) ? 1.0 : HATCH_LEAVES) /
	       (shorter * h.larger * h.larger * max(facing(c, normal), HATCH_FACING));
}

/* How far a point's second stroke is drawn. */
float hatch_second(candidate c, hatch h)
{
	const float w = CROSS_FADE, bend = 2.0 * w * (1.0 - w), end = w / (2.0 * (1.0 - w));
	float part = h.chance * hatch_shape.x, limit = part * (1.0 - w) + w / 2.0;
	if (part < end)
		limit = sqrt(bend * part);
	else if (1.0 - part < end)
		limit = 1.0 - sqrt(bend * (1.0 - part));
	return clamp((limit - chance_by(c, SALT_CROSS) * (1.0 - w)) * (1.0 / w), 0.0, 1.0);
}
