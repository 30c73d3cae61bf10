/* A layer's ink, as ink-put.glsl left it. */
layout(std430, binding = 2) readonly buffer Ink {
	uint ink_words[];
};

uint word_at(ivec2 at, int plane)
{
	return ink_words[(plane * int(size.y) + at.y) * int(size.x) + at.x];
}

vec3 rgb_at(ivec2 at, int plane)
{
	return vec3(float(word_at(at, plane)), float(word_at(at, plane + 1)), float(word_at(at, plane + 2)));
}

vec4 ink_at(ivec2 at)
{
	if (colour.y == LAID)
		return vec4(rgb_at(at, 2), left_of(word_at(at, 1)));
	if (colour.y == PAINTED)
		return vec4(rgb_at(at, 1), left_of(word_at(at, 0)));
	if (colour.y == COLOURED)
		return vec4(left_of(word_at(at, 0)), left_of(word_at(at, 1)), left_of(word_at(at, 2)), 1.0);
	return vec4(colour.y == INKED ? left_of(word_at(at, 0)) : uintBitsToFloat(word_at(at, 0)));
}

vec2 weight_at(ivec2 at)
{
	int plane = colour.y == LAID ? 5 : 4;
	return vec2(float(word_at(at, plane)), colour.y == LAID ? float(word_at(at, plane + 1)) : 0.0);
}
