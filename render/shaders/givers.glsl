/* Points that give strokes, and their copies. */
/* A point with what is the same for all its copies. */
struct giver {
	candidate c;
	vec3 normal;
	bool is_flat, spreads; /* spreads: is moved in the patch that it stands for, and gives copies there */
	uint copies;
	hatch h;
	brush p;
	float wanted, rank, last, most; /* points to a square metre: no rank above the most is drawn */
};

bool giver_of(uint n, uint i, out giver g)
{
	if (!candidate_of(n, i, g.c))
		return false;
	g.copies = 1u;
	g.rank = 0.0;
	g.most = 1.0;
	if (is_on_edge(g.c.kind))
		return true;
	if (is_cut()) {
		g.normal = turned(points[g.c.index].w);
		return is_in_cut(g.c);
	}
	float nearest_m = nearest_of(n, g.c.kind, g.c.depth_m);
	vec2 place = place_in_queue(g.c);
	g.rank = place.x;
	g.last = place.y;
	if (is_hatching()) {
		g.normal = turned(points[g.c.index].w);
		g.wanted = hatch_wanted(g.c, g.normal, g.h);
		g.most = need_on_surface(g.wanted, nearest_m, ray_most()) * more_of(octaves_at(nearest_m));
		g.is_flat = is_flat_here(g.c, g.normal);
		g.spreads = g.normal != vec3(0.0);
		g.copies = g.is_flat ? colour.z : g.spreads ? min(colour.z, LEAVES_COPIES) : 1u;
		return g.rank < g.most;
	}
	if (is_paint()) {
		g.normal = turned(points[g.c.index].w);
		find_brush(g.c, g.normal, g.p);
		g.is_flat = is_flat_paint(g.c, g.normal);
		g.wanted = wanted_per_px[0].x * g.p.part / g.p.aslant * (g.is_flat ? 1.0 : PAINT_LEAVES);
		g.most = need_on_surface(g.wanted, nearest_m, ray_most()) * more_of(octaves_at(nearest_m));
		g.spreads = g.is_flat;
		g.copies = g.is_flat ? colour.z : 1u;
		return g.rank < g.most;
	}
	if (is_contours()) {
		g.normal = turned(points[g.c.index].w);
		g.wanted = wanted_per_px[0].x;
		g.is_flat = g.spreads = g.normal != vec3(0.0);
		g.most = need_on_surface(g.wanted, nearest_m, ray_most()) * more_of(octaves_at(nearest_m));
		if (g.rank >= g.most || (views[n].mask.w > 0.0 && dot(g.normal, ray_of(g.c)) > BEYOND))
			return false;
		float near = smooth_weight(g.c, g.normal, g.h);
		/* It takes long to look around: not of what is hidden anyway. */
		if (contour_least.z > 0.0 && visibility(g.c) > 0.0)
			near = step_weight(g.c, near, g.h);
		g.h.chance = near;
		return near > 0.0;
	}
	g.normal = texels.w > 0.0 ? turned(points[g.c.index].w) : vec3(0.0);
	g.wanted = wanted_at(g.c, g.normal);
	g.most = need_on_surface(g.wanted, nearest_m, ray_most()) * more_of(octaves_at(nearest_m));
	if (g.rank >= g.most)
		return false;
	if (texels.w <= 0.0)
		g.normal = turned(points[g.c.index].w);
	g.is_flat = g.spreads = has_surface(g.c.kind) && g.normal != vec3(0.0);
	if (g.is_flat)
		g.copies = g.c.kind == UNDIRECTED ? min(colour.z, LEAVES_COPIES) : colour.z;
	return true;
}

choice choice_on_surface(giver g, inout candidate c)
{
	choice one;
	one.alpha = 0.0;
	one.edge.is_there = false;
	one.normal = g.normal;
	one.lit = lit_of(one.normal);
	if (g.spreads && look.y > 0.0)
		scatter(c);
	float octaves = octaves_at(c.depth_m), away = away_from(c), larger = 1.0 + focus_reach.z * away;
	float need = need_on_surface(g.wanted, c.depth_m, cosine_of(c, one.normal)) / (larger * larger);
	float fade = fade_of(g.rank, need * more_of(octaves), octaves);
	float front = is_contours() ? 1.0 : facing(c, one.normal);
	if (fade <= 0.0 || front <= 0.0)
		return one;
	one.alpha = fade * front * visibility(c) * (1.0 - focus.w * away);
	float broad = is_paint() ? paint_hole.y / g.p.part : 1.0;
	one.growth = min(growth_of(broad * need / (g.last * float(g.copies))), look.x) * larger;
	if (is_paint()) {
		one.size = size_of(g.p, g.rank, need);
		one.growth *= one.size;
	}
	if (is_contours())
		one.alpha *= g.h.chance;
	if (is_hatching()) {
		one.growth *= g.h.larger;
		one.alpha *= (1.0 - hatch_shape.y * (1.0 - g.h.chance)) * min(g.h.chance * (1.0 / HATCH_FOOT), 1.0);
	}
	if (goes_along(c))
		one.edge = line_of(c);
	if (!g.is_flat)
		one.normal = vec3(0.0);
	return one;
}

/* Of its copy; moves c to where its stroke is. */
choice choice_of(giver g, out candidate c)
{
	choice one;
	c = g.c;
	if (is_cut())
		one = choice_on_cut(g.normal, c);
	else if (is_on_edge(c.kind))
		one = choice_on_edge(c);
	else
		one = choice_on_surface(g, c);
	if (one.alpha > 0.0 && !is_cut())
		one.alpha *= opacity_of(c);
	if (one.alpha < ALPHA_LEAST)
		one.alpha = 0.0;
	return one;
}

/* How many strokes it gives. */
uint strokes_of(giver g, candidate c, choice one)
{
	if (one.alpha <= 0.0)
		return 0u;
	return is_hatching() && one.alpha * hatch_second(c, g.h) >= ALPHA_LEAST ? 2u : 1u;
}

/* for (begin(); has_more(g); next(g)): all its copies that may be drawn. */
void begin()
{
	copy = 0u;
}

bool has_more(giver g)
{
	return copy < g.copies && g.rank < g.most;
}

void next(inout giver g)
{
	copy++;
	g.rank += g.last;
}

/* Of point i of view n, with its copies. */
uint strokes_at(uint n, uint i)
{
	giver g;
	candidate c;
	uint given = 0u;
	if (giver_of(n, i, g))
		for (begin(); has_more(g); next(g)) {
			choice one = choice_of(g, c);
			given += strokes_of(g, c, one);
		}
	return given;
}
