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

float ink_alpha(vec2 own, vec4 pen)
{
	float level = level_of(pen.y);
	vec2 size_here = texels_of(level), at = (own + pen.xy) * (size_here / (2.0 * pen.xy)) + 1.0;
	return textureLod(stroke_texture, vec3(at / (size_here + 2.0), pen.w), level).r;
}
