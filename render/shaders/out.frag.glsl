#version 310 es
/* Linear light to sRGB, by the table of light.h. */
layout(location = 0) out vec4 pixel;
layout(binding = 3) uniform sampler2D canvas;
layout(binding = 5) uniform sampler2D srgb_bytes; /* 64 x 64 steps */

float srgb(float l)
{
	int n = int(clamp(l, 0.0, 1.0) * 4095.0 + 0.5);
	return texelFetch(srgb_bytes, ivec2(n & 63, n >> 6), 0).r;
}

void main()
{
	vec3 c = texelFetch(canvas, ivec2(gl_FragCoord.xy), 0).rgb;
	pixel = vec4(srgb(c.r), srgb(c.g), srgb(c.b), 1.0);
}
