/* The paper's relief at a pixel, -1 .. 1. */
layout(binding = 2) uniform sampler2D relief;

float relief_at(vec2 pixel)
{
	return (texelFetch(relief, ivec2(pixel), 0).r * 255.0 - 128.0) / 128.0;
}
