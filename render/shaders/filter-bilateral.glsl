#version 310 es
/* The bilateral filter: pixels to CIELab in plane b; along rows or columns, from plane a into b; back from a to spare pixels. Three numbers
 * a pixel. by: per_tone, then the weights; whole: radius. */
const int TO_LAB = 0, ACROSS = 1, DOWN = 2, OF_LAB = 3;

float weight_of(int k)
{
	return by[1 + (k >> 2)][k & 3];
}

vec3 taken(ivec2 p)
{
	int at = 3 * at_of(inside(p));
	return vec3(a[at], a[at + 1], a[at + 2]);
}

/* e^-x as (1 - x/256)^256 */
float fall(float x)
{
	float e = max(1.0 - x * (1.0 / 256.0), 0.0);
	for (int n = 0; n < 8; n++)
		e *= e;
	return e;
}

void add(vec3 there, vec3 middle, float weight, inout vec4 sum)
{
	vec3 apart = there - middle;
	float w = fall(dot(apart, apart) * by[0].x) * weight;
	sum += vec4(there, 1.0) * w;
}

vec3 smoothed(ivec2 p, ivec2 on)
{
	vec3 middle = taken(p);
	vec4 sum = vec4(middle, 1.0);
	for (int n = 1; n <= whole[0].x; n++) {
		add(taken(p - n * on), middle, weight_of(n), sum);
		add(taken(p + n * on), middle, weight_of(n), sum);
	}
	return sum.rgb / sum.a;
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	if (extent.z == OF_LAB) {
		spare[at] = rgba_of_lab(taken(p));
		return;
	}
	vec3 lab = extent.z == TO_LAB ? lab_of(pixels[at]) : smoothed(p, extent.z == DOWN ? ivec2(0, 1) : ivec2(1, 0));
	for (int k = 0; k < 3; k++)
		b[3 * at + k] = lab[k];
}
