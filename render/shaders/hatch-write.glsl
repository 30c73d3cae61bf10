/* Where strokes are written to; those of hatching, and their colours. */
layout(std430, binding = 6) writeonly buffer Strokes {
	uint strokes[]; /* x y along, half_width alpha q slope, slope, rgb and variant */
};
const uint WORDS = 10u;

/* 1/depth over the screen, of the plane through a point. */
vec2 plane_slope(candidate c, vec3 normal, float around_px)
{
	float steepest = 0.5 / (c.depth_m * max(around_px, 1.0));
	float away = dot(normal, ray_of(c)) * c.depth_m * lens.x * stretch(c.depth_m);
	return abs(away) > 1e-6 ? clamp(normal.xy / away, -steepest, steepest) : vec2(0.0);
}

/* sRGB 0..1 of three bytes in a word. */
vec3 srgb_of(uint rgb)
{
	return vec3(uvec3(rgb, rgb >> 8, rgb >> 16) & 255u) * (1.0 / 255.0);
}

/* Hue 0..6, saturation, value. */
vec3 hsv_of(vec3 rgb)
{
	float most = max(rgb.r, max(rgb.g, rgb.b)), range = most - min(rgb.r, min(rgb.g, rgb.b));
	if (range <= 0.0)
		return vec3(0.0, 0.0, most);
	float hue = most == rgb.r   ? (rgb.g - rgb.b) / range
		    : most == rgb.g ? 2.0 + (rgb.b - rgb.r) / range
				    : 4.0 + (rgb.r - rgb.g) / range;
	return vec3(hue < 0.0 ? hue + 6.0 : hue, range / most, most);
}

vec3 rgb_of(vec3 hsv)
{
	vec3 away = abs(hsv.x - vec3(0.0, 2.0, 4.0));
	vec3 full = clamp(2.0 - min(away, 6.0 - away), 0.0, 1.0);
	return hsv.z * (1.0 - hsv.y * (1.0 - full));
}

/* The pencil of the two beside the hue that chance takes. */
vec4 pencil_for(float hue, float by)
{
	uint count = hatch_which.w, n = 0u;
	while (n < count && pencils[n].w <= hue)
		n++;
	vec4 below = pencils[(n + count - 1u) % count], above = pencils[n % count];
	float room = above.w - below.w, away = hue - below.w;
	room += room <= 0.0 ? 6.0 : 0.0;
	away += away < 0.0 ? 6.0 : 0.0;
	return by * room < away ? above : below;
}

vec3 drawn_with_pencils(candidate c, vec3 rgb, float shift)
{
	vec3 hsv = hsv_of(rgb);
	hsv.x += shift;
	hsv.x -= 6.0 * floor(hsv.x * (1.0 / 6.0));
	if (hatch_which.w == 0u)
		return shift != 0.0 ? rgb_of(hsv) : rgb;
	vec3 p = pencil_for(hsv.x, chance_by(c, SALT_PENCIL)).rgb;
	float part = min(hsv.y / max(1.0 - min(p.r, min(p.g, p.b)), 1e-3), 1.0);
	return hsv.z * (1.0 - part * (1.0 - p));
}

uint hatch_colour(candidate c, hatch h)
{
	vec3 xtoon = texelFetch(xtoon_colours, h.shade, 0).rgb, rgb = xtoon;
	float shift = 0.0;
	if (hatch_which.z > XTOON) {
		uint rgba = looks[c.index].x;
		float grey = float(lightness_of(rgba));
		if (rgba >> 24 != 0u)
			rgb = exposed(hatch_own.x, clamp((grey + look.z * (255.0 * srgb_of(rgba) - grey)) * (1.0 / 255.0), 0.0, 1.0));
		rgb += (hatch_which.z == BLENDED ? hatch_line.z : 0.0) * (xtoon - rgb);
		shift = hatch_line.w;
	}
	uvec3 b = uvec3(255.0 * drawn_with_pencils(c, rgb, shift) + 0.5);
	return b.x | b.y << 8 | b.z << 16;
}

/* The point's way, turned by the layer's angle and by chance, or the one across. */
vec3 turned_way(candidate c, hatch h, uint second)
{
	int n = int(chance_by(c, 2u * copy * SALTS + SALT_ANGLE) * 256.0);
	vec2 by = (n & 1) == 0 ? turns[n >> 1].xy : turns[n >> 1].zw;
	float across = by.x * hatch_line.x - by.y * hatch_line.y, up = by.y * hatch_line.x + by.x * hatch_line.y;
	return second == 0u ? across * h.way[0] + up * h.way[1] : across * h.way[1] - up * h.way[0];
}

void write_hatch(uint at, candidate c, choice one, hatch h, uint second)
{
	uint salts = (2u * copy + second) * SALTS;
	vec3 way = turned_way(c, h, second), seen = way_on_screen(c, way);
	float length_px = one.growth * shape.x;
	float half_px = 0.5 * length_px * (1.0 + shape.w * (2.0 * chance_by(c, salts + SALT_LENGTH) - 1.0)) *
			straight_part(h.bent[second], length_px, c.depth_m) * clamp(seen.z, SHORTEST_SEEN, 1.0);
	vec2 slope = is_flat_here(c, one.normal) ? plane_slope(c, one.normal, half_px) : vec2(0.0);
	float alpha = second == 0u ? one.alpha : one.alpha * hatch_second(c, h);
	float word[9] = float[9](c.at.x, c.at.y, half_px * seen.x, half_px * seen.y, one.growth * shape.y / 2.0,
		alpha, 1.0 / c.depth_m, slope.x, slope.y);
	for (uint k = 0u; k < 9u; k++)
		strokes[at * WORDS + k] = floatBitsToUint(word[k]);
	uint variant = uint(chance_by(c, salts + SALT_VARIANT) * texels.z);
	strokes[at * WORDS + 9u] = hatch_colour(c, h) | variant << 24;
}
