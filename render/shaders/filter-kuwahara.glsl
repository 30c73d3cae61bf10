#version 310 es
/* Kuwahara's filter: sums along rows, then of columns the mean and the variance of each square, by its left upper corner; each pixel
 * takes the mean of the least variance of the four squares that it is a corner of. by: softness. whole: radius. */
const int ACROSS = 0, DOWN = 1, TAKE = 2;
const float EVEN = 2.0; /* KUWAHARA_EVEN */

layout(std430, binding = 4) buffer Sums {
	ivec4 sums[]; /* red green blue squares, of radius + 1 pixels */
};
layout(std430, binding = 5) buffer Squares {
	uvec2 squares[]; /* mean, bits of the variance */
};

/* Squares begin radius pixels before the picture. */
void across(ivec2 p, int radius)
{
	ivec4 sum = ivec4(0);
	for (int x = p.x - radius; x <= p.x; x++) {
		uint rgba = pixels[at_of(inside(ivec2(x, p.y)))];
		ivec3 c = ivec3(uvec3(rgba, rgba >> 8, rgba >> 16) & 255u);
		sum += ivec4(c, c.r * c.r + c.g * c.g + c.b * c.b);
	}
	sums[p.y * extent.x + p.x] = sum;
}

void down(ivec2 p, int radius)
{
	ivec4 sum = ivec4(0);
	for (int y = p.y - radius; y <= p.y; y++)
		sum += sums[clamp(y, 0, area.y - 1) * extent.x + p.x];
	float by_count = 1.0 / float((radius + 1) * (radius + 1));
	vec3 mean = vec3(sum.rgb) * by_count;
	float variance = float(sum.a) * by_count - mean.r * mean.r - mean.g * mean.g - mean.b * mean.b;
	squares[p.y * extent.x + p.x] = uvec2(rgba_of(mean), floatBitsToUint(max(variance, 0.0)));
}

void take(ivec2 p, int radius)
{
	int pitch = area.x + radius;
	uvec2 best = uvec2(0u, 0xffffffffu);
	vec4 sum = vec4(0.0);
	for (int n = 0; n < 4; n++) {
		uvec2 other = squares[(p.y + (n >> 1) * radius) * pitch + p.x + (n & 1) * radius];
		float weight = 1.0 / (uintBitsToFloat(other.y) + EVEN);
		weight *= weight;
		sum += vec4(rgb_of(other.x), 1.0) * weight * weight;
		/* Of floats that are not below 0, bits are in their order. */
		if (other.y < best.y)
			best = other;
	}
	float softness = by[0].x;
	spare[at_of(p)] = softness > 0.0 ? rgba_of(softness / sum.a * sum.rgb + (1.0 - softness) * rgb_of(best.x))
					 : best.x;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	if (extent.z == ACROSS)
		across(p, whole[0].x);
	else if (extent.z == DOWN)
		down(p, whole[0].x);
	else
		take(p, whole[0].x);
}
