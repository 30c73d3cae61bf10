#version 310 es
/* What runs where (filter_flow_find), at half the size: means of 2 x 2 pixels, structure tensor, and what becomes of its Gaussian
 * means. Planes: a is read, b is written, three numbers a pixel. */
const int HALVE = 0, TENSOR = 1, FLOW = 2;

void halve(ivec2 p, int at)
{
	ivec2 low = min(2 * p + 1, area.xy - 1);
	vec3 sum = rgb_of(pixels[at_of(2 * p)]) + rgb_of(pixels[at_of(ivec2(low.x, 2 * p.y))]) +
		   rgb_of(pixels[at_of(ivec2(2 * p.x, low.y))]) + rgb_of(pixels[at_of(low)]);
	sum *= 1.0 / 1020.0;
	for (int k = 0; k < 3; k++)
		b[at + k] = sum[k];
}

vec3 half_at(ivec2 p)
{
	p = clamp(p, ivec2(0), extent.xy - 1);
	int at = 3 * (p.y * extent.x + p.x);
	return vec3(a[at], a[at + 1], a[at + 2]);
}

void tensor(ivec2 p, int at)
{
	vec3 nw = half_at(p + ivec2(-1, -1)), n = half_at(p + ivec2(0, -1)), ne = half_at(p + ivec2(1, -1));
	vec3 w = half_at(p + ivec2(-1, 0)), e = half_at(p + ivec2(1, 0));
	vec3 sw = half_at(p + ivec2(-1, 1)), s = half_at(p + ivec2(0, 1)), se = half_at(p + ivec2(1, 1));
	vec3 right = ne + 2.0 * e + se - nw - 2.0 * w - sw, down = sw + 2.0 * s + se - nw - 2.0 * n - ne;
	b[at] = dot(right, right) / 16.0;
	b[at + 1] = dot(right, down) / 16.0;
	b[at + 2] = dot(down, down) / 16.0;
}

void flow(int at)
{
	float xx = a[at], xy = a[at + 1], yy = a[at + 2];
	float mean = (xx + yy) / 2.0, part = (xx - yy) / 2.0, apart = sqrt(part * part + xy * xy);
	vec2 way = vec2(part > 0.0 ? -xy : apart - part, part > 0.0 ? apart + part : -xy);
	float reach = sqrt(dot(way, way));
	way = reach > 1e-12 ? way / reach : vec2(1.0, 0.0);
	b[at] = way.x;
	b[at + 1] = way.y;
	b[at + 2] = mean > 1e-9 ? apart / mean : 0.0;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = 3 * (p.y * extent.x + p.x);
	if (extent.z == HALVE)
		halve(p, at);
	else if (extent.z == TENSOR)
		tensor(p, at);
	else
		flow(at);
}
