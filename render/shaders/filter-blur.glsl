#version 310 es
/* Gaussian means (filter_blur_run), along rows or columns, from pixels or plane a into plane b or spare pixels. */
const int FROM_PIXELS = 1, TO_PIXELS = 2;

float weight_of(int k)
{
	return by[k >> 2][k & 3];
}

vec4 taken(ivec2 p)
{
	p = clamp(p, ivec2(0), extent.xy - 1);
	int at = p.y * extent.x + p.x, channels = whole[0].y;
	if ((whole[0].w & FROM_PIXELS) != 0)
		return vec4(rgb_of(pixels[at]), 255.0);
	if (channels == 1)
		return vec4(a[at], 0.0, 0.0, 0.0);
	at *= channels;
	return vec4(a[at], a[at + 1], a[at + 2], channels > 3 ? a[at + 3] : 0.0);
}

void main()
{
	ivec2 p, on = whole[0].z != 0 ? ivec2(0, 1) : ivec2(1, 0);
	if (!is_here(p))
		return;
	vec4 sum = taken(p) * weight_of(0);
	for (int k = 1; k <= whole[0].x; k++)
		sum += (taken(p - k * on) + taken(p + k * on)) * weight_of(k);
	int at = p.y * extent.x + p.x, channels = whole[0].y;
	if ((whole[0].w & TO_PIXELS) != 0) {
		spare[at] = rgba_of(sum.rgb);
		return;
	}
	for (int k = 0; k < channels; k++)
		b[at * channels + k] = sum[k];
}
