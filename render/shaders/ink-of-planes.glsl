/* A layer's ink, as blending left it in textures. */
layout(binding = 3) uniform sampler2D ink_plane;
layout(binding = 4) uniform sampler2D weight_plane;

/* What is left of what is below, in alpha where rgb are sums of paint. */
vec4 ink_at(ivec2 at)
{
	return texelFetch(ink_plane, at, 0);
}

/* Of paint: its sum, and how thick. */
vec2 weight_at(ivec2 at)
{
	return texelFetch(weight_plane, at, 0).rg;
}
