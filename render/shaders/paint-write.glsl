/* Writes brush strokes, and finds their colours. */
const float WARMTH_MIDDLE = 0.5, WARMTH_CHANCE = 0.35, CELLS_AROUND = 1.5, CELLS_CHUNK = 12.0, OWN_DETAIL = 0.75;
const float LAY_RISE = 0.32, LAY_FINE = 0.6, LAYS = 64.0, DISC = 0.5;
const uint SALT_LAY = 0u, SALT_SHADE = 7u, SALT_WARMTH = 65538u, SALT_HUE = 65539u;

/* 0..255. */
vec3 bytes_of(uint rgb)
{
	return vec3(uvec3(rgb, rgb >> 8, rgb >> 16) & 255u);
}

vec3 evened(candidate c, brush p, uint rgba, float width_m)
{
	float detail = float(p.rgb_detail >> 24) * (1.0 / 255.0), cells = width_m / abs(views[c.view].crown.w);
	float even = paint_look.x * (1.0 - OWN_DETAIL * detail);
	float around = even * clamp(2.0 * cells / CELLS_AROUND - 1.0, 0.0, 1.0);
	float chunks = even * clamp((cells - CELLS_AROUND) * (1.0 / (CELLS_CHUNK - CELLS_AROUND)), 0.0, 1.0);
	vec3 own = bytes_of(rgba);
	own += around * (bytes_of(p.rgb_detail) - own);
	return own + chunks * (bytes_of(views[c.view].paint.x) - own);
}

uint paint_colour(candidate c, brush p, float width_m, float lit)
{
	const vec3 warm = vec3(34.0, 8.0, -40.0);
	vec3 rgb = 255.0 * exposed(paint_hole.z, evened(c, p, looks[c.index].x, width_m) * (1.0 / 255.0));
	float grey = dot(rgb, vec3(0.299, 0.587, 0.114));
	float warmth = paint_look.z * (2.0 * (grey * (1.0 / 255.0) - WARMTH_MIDDLE) +
					      WARMTH_CHANCE * (2.0 * chance_by(c, SALT_WARMTH) - 1.0));
	lit *= 1.0 + paint_thick.z * around_zero(c, SALT_SHADE);
	rgb = 127.5 + paint_look.y * (grey + look.z * (rgb - grey) - 127.5);
	rgb = clamp(lit * (rgb + warmth * warm) * (1.0 / 255.0), 0.0, 1.0);
	float shift = paint_look.w * (2.0 * chance_by(c, SALT_HUE) - 1.0);
	uvec3 b = uvec3(255.0 * drawn_with_pencils(c, rgb, shift) + 0.5);
	return b.x | b.y << 8 | b.z << 16;
}

void write_paint(uint at, candidate c, choice one, brush p)
{
	float turn_by = around_zero(c, SALT_ANGLE);
	if (one.normal != vec3(0.0)) /* it is flat */
		turn_by = 0.7 * p.wave + 0.3 * turn_by;
	int n = int(127.5 + 127.5 * turn_by);
	vec2 by = (n & 1) == 0 ? turns[n >> 1].xy : turns[n >> 1].zw;
	vec2 along = way_on_screen(c, by.x * p.along + by.y * p.up).xy;
	float half_px = 0.5 * shape.x * one.growth * (1.0 + shape.w * around_zero(c, SALT_LENGTH)) * p.shorter;
	float half_width = 0.5 * shape.y * one.growth * p.aslant / p.shorter;
	float disc_px = float(points[c.index].z & 0x7fffu) * (DISC * views[c.view].mask.x * UNIT_M * lens.x) / scale_m(c.depth_m);
	half_px = max(half_px, p.shorter * min(disc_px, 0.5 * shape.x));
	half_width = max(half_width, p.aslant / p.shorter * min(disc_px, shape.y));
	vec2 slope = plane_slope(c, one.normal, half_px);
	float word[9] = float[9](c.at.x, c.at.y, half_px * along.x, half_px * along.y,
		half_width, one.alpha, 1.0 / c.depth_m, slope.x, slope.y);
	for (uint k = 0u; k < 9u; k++)
		strokes[at * WORDS + k] = floatBitsToUint(word[k]);
	float fine = paint_size.y, part = fine < 1.0 ? (1.0 - one.size) / (1.0 - fine) : 0.0;
	float place = LAY_FINE * part + (1.0 - LAY_FINE) * chance(c, SALT_LAY);
	uint lay = uint((LAYS - 0.01) * (LAY_RISE * one.alpha + (1.0 - LAY_RISE) * place));
	uint variant = uint(chance(c, SALT_VARIANT) * texels.z);
	float width_m = shape.y * one.growth * scale_m(c.depth_m) / lens.x;
	strokes[at * WORDS + 9u] =
		paint_colour(c, p, width_m, texels.w == LIT_COLOUR ? one.lit : 1.0) | (variant | lay << 2) << 24;
}
