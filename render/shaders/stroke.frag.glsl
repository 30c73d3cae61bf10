#version 310 es
/* What a stroke leaves in a pixel: factors that the blending multiplies, or of paint its sums. */
flat in vec4 pen_place, pen_body, pen_lay;
flat in vec3 pen_plane, pen_colour;
layout(location = 0) out vec4 ink;
layout(location = 1) out vec4 weight;

void main()
{
	pen p = pen(pen_place, pen_body, pen_plane, pen_colour, pen_lay);
	if (colour.y == LAID) {
		vec3 laid;
		if (!is_laid_at(p, gl_FragCoord.xy, laid))
			discard;
		float high = laid.x * power_of_two(laid.y);
		ink = vec4(high * p.colour, 1.0 - laid.x);
		weight = vec4(high, high * laid.z, 0.0, 0.0);
		return;
	}
	float alpha = alpha_at(p, gl_FragCoord.xy);
	if (!(alpha > 0.0))
		discard;
	weight = vec4(alpha);
	if (colour.y == PAINTED)
		ink = vec4(alpha * p.colour, 1.0 - alpha);
	else if (colour.y == COLOURED)
		ink = vec4(left_by(p, alpha), 1.0);
	else
		ink = vec4(1.0 - alpha);
}
