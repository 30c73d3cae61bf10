#version 310 es
/* The quad of a stroke: all pixels that its kernel can have ink in. */
layout(location = 0) in vec4 place;
layout(location = 1) in vec4 body;
layout(location = 2) in float slope_down;
layout(location = 3) in uint rgb_variant;
flat out vec4 pen_place, pen_body, pen_lay;
flat out vec3 pen_plane, pen_colour;

void main()
{
	pen p = pen_of(place, body, slope_down, rgb_variant);
	vec2 most = reach_of(p), along = p.place.zw;
	vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
	vec2 at = place.xy + corner.x * most.x * along + corner.y * most.y * vec2(-along.y, along.x);
	gl_Position = vec4(at / size.xy * 2.0 - 1.0, 0.0, 1.0);
	pen_place = p.place;
	pen_body = p.body;
	pen_plane = p.plane;
	pen_colour = p.colour;
	pen_lay = p.lay;
}
