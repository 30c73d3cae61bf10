#version 310 es
/* Colour grading. by: three rows that turn hues; saturation, warmth, tint_amount, segments; tint; from 8 on the curve of bytes. Plane d has
 * normals and segments. */
float curve(uint byte)
{
	return by[8u + (byte >> 2)][byte & 3u];
}

/* Of about this lightness, whatever it was. */
vec3 tinted(vec3 tint, float lightness)
{
	float own = dot(tint, vec3(0.299, 0.587, 0.114));
	return lightness < own ? tint * lightness / max(own, 1e-3)
			       : tint + (1.0 - tint) * (lightness - own) / max(1.0 - own, 1e-3);
}

vec3 colour_of_leaf(uint leaf)
{
	float hue = 6.0 * float(leaf * 0x9e3779b9u) / 4294967296.0, strong = 0.45 + 0.25 * unit_of(leaf, 1u, 9u);
	vec3 apart = abs(mod(hue + vec3(6.0, 4.0, 2.0), 6.0) - 3.0);
	return 0.62 + strong * (clamp(apart - 1.0, 0.0, 1.0) - 0.55);
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	uint rgba = pixels[at];
	if (is_bare(at)) {
		spare[at] = rgba;
		return;
	}
	vec3 in_rgb = vec3(curve(rgba & 255u), curve(rgba >> 8 & 255u), curve(rgba >> 16 & 255u));
	vec3 colour = vec3(dot(by[0].xyz, in_rgb), dot(by[1].xyz, in_rgb), dot(by[2].xyz, in_rgb));
	float grey = dot(colour, vec3(0.299, 0.587, 0.114));
	vec4 rule = by[3];
	colour = grey + rule.x * (colour - grey);
	colour.r += 0.12 * rule.y * grey;
	colour.b -= 0.16 * rule.y * grey;
	if (rule.z > 0.0)
		colour = mix(colour, tinted(by[4].rgb, grey), rule.z);
	uint leaf = rule.w > 0.0 ? uint(d[4 * at + 3]) : 0u;
	if (leaf != 0u)
		colour = mix(colour, tinted(colour_of_leaf(leaf), 0.35 + 0.5 * grey), rule.w);
	spare[at] = rgba_of(255.0 * colour);
}
