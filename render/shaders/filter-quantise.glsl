#version 310 es
/* Steps of lightness, of CIELab in plane a and smoothed lightness in c; or of each channel, smoothed in c if whole is 1. Before the former,
 * lightness of a into b. by: levels, softness. */
const int LIGHTNESS = 0, CHANNELS = 1;
const float GRADIENT_SHARP = 3.0, TANH_SOFT = 0.6, TANH_SHARP = 14.0;
const float BETWEEN = 4.0;

float smooth_at(ivec2 p)
{
	return c[at_of(inside(p))];
}

/* Of numbers from 0 to the most. */
float step_of(float x, float most, float sharp)
{
	float wide = most / (by[0].x - 1.0), level = roundEven(x / wide) * wide;
	float tanh_by = TANH_SOFT + sharp * sharp * (TANH_SHARP - TANH_SOFT);
	float within = (x - level) / wide;
	return level + wide / 2.0 * (within < 0.0 ? -1.0 : 1.0) *
			       (1.0 - tanh(tanh_by * (0.5 - abs(within))) / tanh(tanh_by / 2.0));
}

uint lightness_of_lab(ivec2 p, int at)
{
	vec2 change = vec2(smooth_at(p + ivec2(1, 0)) - smooth_at(p - ivec2(1, 0)),
		smooth_at(p + ivec2(0, 1)) - smooth_at(p - ivec2(0, 1)));
	float sharp = 1.0 - by[0].y * (1.0 - min(length(change) / 2.0 / GRADIENT_SHARP, 1.0));
	float lightness = a[3 * at] + step_of(c[at], 100.0, sharp) - c[at];
	return rgba_of_lab(vec3(lightness, a[3 * at + 1], a[3 * at + 2]));
}

/* In steps as fine as the table of filter-quantise.c. */
float channel(float own, float smoothed)
{
	float v = floor(smoothed * BETWEEN + 0.5) / (255.0 * BETWEEN), last = by[0].x - 1.0;
	float to = by[0].y > 0.0 ? 255.0 * step_of(v, 1.0, 1.0 - by[0].y)
				 : floor(roundEven(v * last) / last * 255.0 + 0.5);
	return own + to - smoothed;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (extent.z > CHANNELS) {
		b[at] = a[3 * at];
	} else if (is_bare(at)) {
		spare[at] = bare_rgba();
	} else if (extent.z == LIGHTNESS) {
		spare[at] = lightness_of_lab(p, at);
	} else {
		vec3 own = rgb_of(pixels[at]), smoothed = own;
		if (whole[0].x != 0)
			smoothed = vec3(c[4 * at], c[4 * at + 1], c[4 * at + 2]);
		spare[at] = rgba_of(vec3(channel(own.r, smoothed.r), channel(own.g, smoothed.g),
			channel(own.b, smoothed.b)));
	}
}
