/* The paper's relief at a pixel, -1 .. 1. */
layout(binding = 2) uniform sampler2D paper_heights;

float relief_at(vec2 pixel)
{
	vec2 at = (pixel * paper_step.x + 0.5) / paper_step.y;
	return (textureLod(paper_heights, at, 0.0).r * 255.0 - 128.0) / 128.0;
}
