#version 310 es
/* Light on the relief of the paint, whose height is in plane a. by: relief, shine, variation, canvas. */
const float RELIEF = 0.45, TONE = 0.6;
const vec3 LIGHT = vec3(-0.45, -0.55, 0.70);

float height_at(ivec2 p)
{
	return a[at_of(p)] + by[0].w * relief_at(vec2(p + area.zw));
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (is_bare(at)) {
		spare[at] = bare_rgba();
		return;
	}
	float here = height_at(p);
	vec2 n = -RELIEF * by[0].x *
		 vec2(height_at(inside(p + ivec2(1, 0))) - here, height_at(inside(p + ivec2(0, 1))) - here);
	float by_length = inversesqrt(dot(n, n) + 1.0);
	float facing = (dot(n, LIGHT.xy) + LIGHT.z) * by_length;
	float glint = max(2.0 * facing * by_length - LIGHT.z, 0.0);
	glint *= glint;
	glint *= glint;
	glint *= glint;
	glint *= glint;
	float tone = (1.0 + TONE * (facing - LIGHT.z)) * (1.0 + by[0].z * a[at]);
	spare[at] = rgba_of(rgb_of(pixels[at]) * tone + 255.0 * by[0].y * glint);
}
