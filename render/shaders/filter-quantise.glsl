#version 310 es
/* Steps of lightness, of CIELab in plane a, or of each channel. by: levels, softness. */
const int LIGHTNESS = 0;
const float GRADIENT_SHARP = 2.0, TANH_SOFT = 0.6, TANH_SHARP = 14.0;

float lightness_at(ivec2 p)
{
	return a[3 * at_of(inside(p))];
}

float step_of(float lightness, float gradient)
{
	float wide = 100.0 / (by[0].x - 1.0), level = roundEven(lightness / wide) * wide;
	float sharp = 1.0 - by[0].y * (1.0 - min(gradient / GRADIENT_SHARP, 1.0));
	float tanh_by = TANH_SOFT + sharp * sharp * (TANH_SHARP - TANH_SOFT);
	float within = (lightness - level) / wide;
	return level + wide / 2.0 * (within < 0.0 ? -1.0 : 1.0) *
			       (1.0 - tanh(tanh_by * (0.5 - abs(within))) / tanh(tanh_by / 2.0));
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (is_bare(at)) {
		spare[at] = bare_rgba();
	} else if (extent.z == LIGHTNESS) {
		vec2 change = vec2(lightness_at(p + ivec2(1, 0)) - lightness_at(p - ivec2(1, 0)),
			lightness_at(p + ivec2(0, 1)) - lightness_at(p - ivec2(0, 1)));
		spare[at] = rgba_of_lab(vec3(step_of(a[3 * at], length(change) / 2.0), a[3 * at + 1], a[3 * at + 2]));
	} else {
		float last = by[0].x - 1.0;
		spare[at] = rgba_of(floor(roundEven(rgb_of(pixels[at]) / 255.0 * last) / last * 255.0 + 0.5));
	}
}
