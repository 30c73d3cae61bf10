#version 310 es
/* Writes the strokes that were marked, as instances of quads. */
layout(local_size_x = 256) in;
layout(location = 2) uniform uint capacity;

vec2 turned_along(vec2 along, float half_px, candidate c)
{
	int n = int(chance(c, SALT_ANGLE) * 256.0);
	vec2 turn_by = (n & 1) == 0 ? turns[n >> 1].xy : turns[n >> 1].zw;
	return half_px * vec2(along.x * turn_by.x - along.y * turn_by.y,
				 along.x * turn_by.y + along.y * turn_by.x);
}

uint colour_of(candidate c, float lit)
{
	uint rgba = looks[c.index].x;
	if (which.w == 0u || rgba >> 24 == 0u)
		return colour.x & 0xffffffu;
	float grey = float(lightness_of(rgba));
	vec3 own = vec3(uvec3(rgba, rgba >> 8, rgba >> 16) & 255u);
	uvec3 b = uvec3(clamp((texels.w == LIT_COLOUR ? lit : 1.0) * (grey + look.z * (own - grey)) + 0.5, 0.0, 255.0));
	return b.x | b.y << 8 | b.z << 16;
}

void write_stroke(uint at, candidate c, choice one, hatch h)
{
	vec2 slope = vec2(0.0), along;
	if (is_contours()) {
		vec3 seen = way_on_screen(c, h.way[0]);
		one.edge = line(true, seen.xy, seen.z * lens.x / scale_m(c.depth_m),
			-h.way[0].z / (c.depth_m * lens.x * max(seen.z, 1e-3) * stretch(c.depth_m)));
	}
	float half_px = one.growth * shape.x / 2.0 * (1.0 + shape.w * around_zero(c, SALT_LENGTH));
	if (is_cut()) {
		half_px = cut_half_px(c, half_px);
		along = turned_along(one.edge.along, half_px, c);
	} else if (one.edge.is_there) {
		float seen = one.edge.px_per_m * scale_m(c.depth_m) / lens.x;
		half_px *= clamp(is_contours() ? seen : 2.0 * seen, FORESHORTENED, 1.0);
		along = turned_along(one.edge.along, half_px, c);
		slope = one.edge.slope * (is_contours() ? normalize(along) : one.edge.along);
	} else {
		along = turned_along(own_way.xy, half_px, c);
		slope = plane_slope(c, one.normal, half_px);
	}
	float word[9] = float[9](c.at.x, c.at.y, along.x, along.y, one.growth * shape.y / 2.0, one.alpha,
		is_cut() ? CUT_BEFORE / lens.w : 1.0 / c.depth_m, slope.x, slope.y);
	for (uint k = 0u; k < 9u; k++)
		strokes[at * WORDS + k] = floatBitsToUint(word[k]);
	uint variant = uint(chance(c, SALT_VARIANT) * texels.z);
	strokes[at * WORDS + 9u] = colour_of(c, one.lit) | variant << 24;
}

void main()
{
	uint lane, n = view_here(lane), word, at;
	if (!strokes_begin(n, lane, word, at))
		return;
	for (uint mark = word & 0xffffu; mark != 0u; mark = next_mark(mark)) {
		giver g;
		candidate c;
		if (giver_of(n, point_at(n, mark, lane), g))
			for (begin(); has_more(g) && at < capacity; next(g)) {
				choice one = choice_of(g, c);
				uint count = strokes_of(g, c, one);
				if (is_hatching())
					for (uint k = 0u; k < count && at < capacity; k++)
						write_hatch(at++, c, one, g.h, k);
				else if (is_paint() && count != 0u)
					write_paint(at++, c, one, g.p);
				else if (count != 0u)
					write_stroke(at++, c, one, g.h);
			}
	}
}
