#version 310 es
/* Strokes where planes cut through the site (filter-pencil.c). Planes: a lightness, b press, c sway in metres, d normals and segments. by: across of
 * each of six layers; from 8 on the eye in planes of each octave, twelve for a layer; from 80 on spacing_px, width_px, wobble_px, pressure;
 * own_colour; colour. whole: how many layers; from 8 on the eye's plane. */
const int LOWEST = -24, OCTAVES = 48, PARAMETERS = 80, LAYERS_MOST = 6;
const float SWAY = 0.0009;
const float NEXT_LAYER = 0.85, BARE = 0.06;

struct sketched {
	vec3 ray, way, normal; /* way: from the eye to it */
	float depth_m;
};

sketched sketched_at(ivec2 p)
{
	int at = at_of(p);
	vec3 n = vec3(d[4 * at], d[4 * at + 1], d[4 * at + 2]);
	vec2 seen = (vec2(p + area.zw) + 0.5 - lens.yz) / lens.x;
	vec3 ray = vec3(seen * rays.x, 1.0);
	float reach = length(ray);
	if (dot(n, ray) > -0.08 * reach)
		n = -ray / reach;
	return sketched(ray, vec3(seen * (scale_m(depths[at]) / depths[at]), 1.0), n, depths[at]);
}

float metres_a_pixel(sketched s, vec3 across)
{
	float towards = dot(across, s.ray) / dot(s.normal, s.ray);
	return scale_m(s.depth_m) / lens.x * length(across.xy - towards * s.normal.xy);
}

/* A plane's own, whichever octave it is asked in: where it is in the coarsest that has it. */
float plane_press(int layer, int octave, int number)
{
	int finer = number != 0 ? findLSB(number) : 0;
	return unit_of(uint(number >> finer), uint((octave + finer) * LAYERS_MOST + layer), 3u) - 0.5;
}

float light_through(int layer, sketched s, int at, float dark)
{
	vec4 rule = by[PARAMETERS];
	vec3 across = by[layer].xyz;
	float pixel_m = max(metres_a_pixel(s, across), 1e-7);
	float octave = log2(rule.x * bare.a * pixel_m) + 1.0;
	octave = clamp(octave, float(LOWEST), float(LOWEST + OCTAVES - 1));
	float low = floor(octave), part = octave - low;
	int n = int(low) - LOWEST, entry = 8 + layer * (OCTAVES / 4) + (n >> 2);
	float cell_m = 0.5 * exp2(low);
	float sway_m = SWAY * min(rule.z, rule.x) * c[at];
	float place = by[entry][n & 3] + (s.depth_m * dot(across, s.way) + sway_m) / cell_m;
	float number = roundEven(place), away_px = abs(place - number) * cell_m / pixel_m;
	int which = int(number) + whole[entry][n & 3];
	float there = (which & 1) != 0 ? 1.0 - part : 1.0;
	float press = clamp(0.8 + 0.4 * b[at] + 0.6 * plane_press(layer, n, which), 0.0, 1.0);
	float wide = rule.y * bare.a / 2.0 * (0.5 + 0.5 * dark) * (0.5 + 0.5 * press);
	float line = step_between(wide + 0.7, wide - 0.5, away_px) * press * there;
	return 1.0 - rule.w * min(dark * 1.6, 1.0) * line;
}

float sketch_light(ivec2 p)
{
	int at = at_of(p), layers = whole[0].x;
	float light = 1.0, dark = 1.0 - a[at];
	dark = dark * (0.5 + 0.6 * dark) * float(layers) * 1.2;
	if (depths[at] >= FAR || dark <= BARE)
		return 1.0;
	sketched s = sketched_at(p);
	for (int n = 0; n < layers && dark > float(n) * NEXT_LAYER + BARE; n++)
		light *= light_through(n, s, at, min(dark - float(n) * NEXT_LAYER - BARE, 1.0));
	return light;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	float ink = (1.0 - sketch_light(p)) * (1.0 + 0.6 * relief_at(vec2(p + area.zw)));
	vec3 colour = by[PARAMETERS + 2].rgb;
	colour = mix(colour, rgb_of(pixels[at]) * 0.8, by[PARAMETERS + 1].x);
	spare[at] = rgba_of(mix(bare.rgb, colour, clamp(ink, 0.0, 1.0)));
}
