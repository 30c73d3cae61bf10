/* A texture, bilinear, with a border of texels that are 0; variants are its layers, and of paint sizes its levels. */
layout(binding = 1) uniform sampler2DArray stroke_texture;

const float SHARP = 0.7, LAST_LEVEL = 3.0;

/* The one that is sharp for its width (paint_level_of). */
float level_of(float half_width)
{
	float n = 0.0;
	if (paint_size.x > 0.0)
		for (float width = SHARP * shape.y; n < LAST_LEVEL && 2.0 * half_width < width; width /= 2.0)
			n++;
	return n;
}

vec2 texels_of(float level)
{
	return vec2(ivec2(texels.xy + 2.0) >> int(level)) - 2.0;
}

vec2 ink_reach(float half_length, float half_width)
{
	return vec2(half_length, half_width) * (1.0 + 1.0 / texels_of(level_of(half_width)));
}

/* Between four texels by whole numbers, as texture_sum() has it (band-draw-lanes.c): of paint what lies highest counts however little it
 * is, and filters leave out what is less than a byte. */
float sum_of_texels(vec2 own, vec4 pen, float level)
{
	const float PLACES = 128.0;
	vec2 size_here = texels_of(level);
	vec2 place = own * (size_here / (2.0 * pen.xy)) * PLACES + (size_here + 1.0) * (PLACES / 2.0);
	ivec2 whole = ivec2(clamp(place, vec2(0.0), (size_here + 1.0) * PLACES)), at = whole >> 7, part = whole & 127;
	int last = (part.x * part.y + 127) >> 7;
	vec4 weights = vec4(127 - part.x - part.y + last, part.x - last, part.y - last, last);
	vec4 four;
	for (int n = 0; n < 4; n++)
		four[n] = texelFetch(stroke_texture, ivec3(at + ivec2(n & 1, n >> 1), int(pen.w)), int(level)).r;
	return dot(four, weights) * (1.0 / 127.0);
}

float ink_alpha(vec2 own, vec4 pen)
{
	float level = level_of(pen.y);
	if (paint_size.x > 0.0)
		return sum_of_texels(own, pen, level);
	vec2 size_here = texels_of(level), at = (own + pen.xy) * (size_here / (2.0 * pen.xy)) + 1.0;
	return textureLod(stroke_texture, vec3(at / (size_here + 2.0), pen.w), level).r;
}
