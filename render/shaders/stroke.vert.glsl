#version 310 es
/* The quad of a stroke: all pixels that its kernel can have ink in. */
layout(location = 0) in vec4 place; /* x y, from its middle to its end */
layout(location = 1) in vec4 body;  /* half_width, alpha, q, slope */
layout(location = 2) in float slope_down;
layout(location = 3) in uint rgb_variant;
flat out vec4 pen_place; /* x y, cosine, sine */
flat out vec4 pen_body;  /* half_length, half_width, alpha, variant */
flat out vec3 pen_plane; /* 1/depth: q, slope */
flat out vec3 pen_colour;

void main()
{
	float half_length = length(place.zw);
	vec2 along = half_length > 0.0 ? place.zw / half_length : vec2(1.0, 0.0);
	vec2 most = ink_reach(half_length, body.x) + 1.0 / 64.0;
	vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
	vec2 at = place.xy + corner.x * most.x * along + corner.y * most.y * vec2(-along.y, along.x);
	gl_Position = vec4(at / size.xy * 2.0 - 1.0, 0.0, 1.0);
	pen_place = vec4(place.xy, along);
	pen_body = vec4(half_length, body.xy, float(rgb_variant >> 24));
	pen_plane = vec3(body.zw, slope_down);
	pen_colour = light_of_bytes(rgb_variant);
}
