#version 310 es
/* Watercolour: colours from beside, by the noise in planes a and b, with their lightness in d; then, of smoothed lightness in plane a, of
 * turbulence in b and dispersion in d, how dense the pigment is. by: wobble_px, darkening, turbulence, dispersion (0: there is none);
 * grain. */
const int WOBBLE = 0;
const float SAME = 0.02, OTHER = 0.05;
const float CHANGE_MOST = 0.10, CHANGE_TO_DENSITY = 7.0;

float lightness_at(ivec2 p)
{
	return a[at_of(inside(p))];
}

/* Colours stay on their things. */
float carried(int at, vec2 from)
{
	float here = depths[at], there = depths[at_of(nearest(from))];
	if (here >= FAR || there >= FAR)
		return here >= FAR && there >= FAR ? 1.0 : 0.0;
	return step_between(OTHER, SAME, abs(there - here) / here);
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (extent.z == WOBBLE) {
		vec2 sway = 1.6 * by[0].x * vec2(a[at], b[at]);
		uint rgba = rgba_of(colour_between(vec2(p) + carried(at, vec2(p) + sway) * sway));
		spare[at] = rgba;
		d[at] = lightness_of(rgba);
		return;
	}
	float density = 1.0;
	vec2 change = vec2(lightness_at(p + ivec2(1, 0)) - lightness_at(p - ivec2(1, 0)),
		lightness_at(p + ivec2(0, 1)) - lightness_at(p - ivec2(0, 1)));
	density += by[0].y * CHANGE_TO_DENSITY * min(length(change) / 2.0 / bare.a, CHANGE_MOST);
	if (by[0].z > 0.0)
		density += by[0].z * 0.9 * b[at];
	if (by[0].w > 0.0)
		density += by[0].w * 0.5 * d[at];
	density -= by[1].x * 0.35 * relief_at(vec2(p + area.zw));
	vec3 colour = rgb_of(pixels[at]) * (1.0 / 255.0);
	spare[at] = rgba_of(255.0 * (colour - (colour - colour * colour) * (density - 1.0)));
}
