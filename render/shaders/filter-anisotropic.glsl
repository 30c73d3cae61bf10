#version 310 es
/* The anisotropic Kuwahara filter (filter-anisotropic.h), by its list of taps. Plane c has what runs where. by: stretch, sharpness; whole:
 * width of plane c. */
const int WAYS = 48, LENGTHS = 8, SECTORS = 4;
const float PI = 3.14159265;

layout(std430, binding = 6) buffer Flow {
	float c[];
};
layout(std430, binding = 7) readonly buffer Taps {
	ivec4 taps[]; /* x, y, bits of the weight; w: of the first ones where the taps of each ellipse's sectors begin */
};

int ellipse_at(ivec2 p)
{
	int at = 3 * ((p.y >> 1) * whole[0].x + (p.x >> 1));
	float turned = atan(c[at + 1], c[at]) / PI;
	float reach = clamp(c[at + 2] * by[0].x, 0.0, 1.0) * float(LENGTHS - 1);
	int way = (int(roundEven(turned * float(WAYS))) + WAYS) % WAYS;
	return way * LENGTHS + int(roundEven(reach));
}

vec4 taken(ivec2 p)
{
	vec3 rgb = rgb_of(pixels[at_of(inside(p))]) * (1.0 / 255.0);
	return vec4(rgb, dot(rgb, rgb));
}

void add(vec4 mean, inout vec4 sum)
{
	float variance = abs(mean.a - dot(mean.rgb, mean.rgb));
	float weight = 1.0 / (1.0 + exp2(by[0].y / 2.0 * log2(1000.0 * variance + 1e-12)));
	sum += vec4(mean.rgb, 1.0) * weight;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int first = ellipse_at(p) * SECTORS;
	vec4 sum = vec4(0.0);
	for (int k = 0; k < SECTORS; k++) {
		vec4 one = vec4(0.0), other = vec4(0.0);
		for (int n = taps[first + k].w; n < taps[first + k + 1].w; n++) {
			float weight = intBitsToFloat(taps[n].z);
			one += taken(p + taps[n].xy) * weight;
			other += taken(p - taps[n].xy) * weight;
		}
		add(one, sum);
		add(other, sum);
	}
	spare[at_of(p)] = rgba_of(sum.rgb * (255.0 / sum.a));
}
