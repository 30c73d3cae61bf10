/* A texture, bilinear, with a border of texels that are 0; variants are its layers. */
layout(binding = 1) uniform sampler2DArray stroke_texture;

vec2 ink_reach(float half_length, float half_width)
{
	return vec2(half_length, half_width) * (1.0 + 1.0 / texels.xy);
}

float ink_alpha(vec2 own, vec4 pen)
{
	vec2 at = (own + pen.xy) * (texels.xy / (2.0 * pen.xy)) + 1.0;
	return textureLod(stroke_texture, vec3(at / (texels.xy + 2.0), pen.w), 0.0).r;
}
