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
flat out vec4 pen_lay; /* of paint: octaves that it lies high, how thick it must be; from where and to where it reaches */

const uint LAID = 5u;
const float PLANE_ROUGH = 0.6, ROUGH_MOST = 0.06, LAYS = 64.0;

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
	pen_lay = vec4(0.0);
	if (colour.y == LAID) {
		vec2 reach = abs(along) * half_length + abs(along.yx) * body.x;
		float slack = min(PLANE_ROUGH * dot(abs(vec2(body.w, slope_down)), reach) / body.z, ROUGH_MOST);
		pen_body.w = float(rgb_variant >> 24 & 3u);
		pen_lay = vec4(float(rgb_variant >> 26) * paint_lay.x - 0.5 * (paint_lay.x * (LAYS - 1.0) + paint_lay.y),
			1.0 - body.y, 1.0 - slack, paint_lay.z + paint_lay.w * body.z + slack);
	}
}
