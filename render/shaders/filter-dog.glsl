#version 310 es
/* Difference of Gaussians: planes a and b, its fine and coarse means, into d; or the lines of it. by: sharpness, threshold, contrast,
 * opacity; colour. whole: 1: planes are differences already; 1: alone. */
const int COMBINE = 0;

float combined(int at)
{
	return by[0].x > 0.0 ? (1.0 + by[0].x) * a[at] - by[0].x * b[at] : a[at] - b[at];
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (extent.z == COMBINE) {
		d[at] = combined(at);
		return;
	}
	bool alone = whole[0].y != 0;
	uint below = alone ? bare_rgba() : pixels[at];
	float over = (whole[0].x != 0 ? a[at] : combined(at)) - by[0].y, part = 0.0;
	if (over < 0.0)
		part = -tanh(by[0].z * over) * solid_at(p) * by[0].w;
	if (part > 0.0 && !alone)
		part *= weight_at(at);
	spare[at] = part > 0.0 ? rgba_of(mix(rgb_of(below), by[1].rgb, part)) : below;
}
