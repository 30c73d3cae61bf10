/* Which points of a layer become strokes: the rules of stroke.c. Goes on in hatch.glsl and givers.glsl. */
layout(std430, binding = 3) readonly buffer Looks {
	uvec2 looks[]; /* rgba, direction */
};
layout(std430, binding = 4) readonly buffer Lists {
	uint lists[]; /* scene-list.h */
};
/* The copy of a point (stroke.h) that is looked at. */
uint copy = 0u;

const uint DITHER = 1u, UNDIRECTED = 2u, DIRECTED = 3u, LEAVES_COPIES = 8u;
const uint SALT_LENGTH = 1u, SALT_ANGLE = 2u, SALT_OPACITY = 3u, SALT_VARIANT = 4u, SALT_ACROSS = 5u, SALT_DOWN = 6u, SALTS = 8u;
const float COSINE_LEAST = 0.1, COSINE_UNKNOWN = 1.0, FORESHORTENED = 0.25;
const float ALPHA_LEAST = 1.0 / 255.0, COPY_REACH = 1.3, FADE_MEAN = 0.7213;
const vec2 COPY_STEPS = vec2(0.7548777, 0.5698403);
const float LIT_TONE = 1.0, LIT_OMITTED = 2.0, LIT_COLOUR = 3.0;
const uint LIST_NEAR = 0x3f800000u, LIST_STEP = 164482u;
const float LIST_RIDGE = 2.0;
const uint NO_DIRECTION = 0x8000u;

struct candidate {
	uint view, kind, index, point; /* in the slab, in the scene */
	float rank, spacing_m;
	vec2 at;
	float depth_m;
};

struct line {
	bool is_there;
	vec2 along;
	float px_per_m, slope;
};

/* What becomes of a candidate; alpha 0: nothing. normal 0 0 0: all of one depth. lit: what is left of its colour. */
struct choice {
	float alpha, growth, lit, size;
	line edge;
	vec3 normal;
};

/* stroke_chance() */
float chance_by(candidate c, uint salt)
{
	uint x = c.point * 0x9E3779B9u ^ salt * 0x85EBCA6Bu;
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	x ^= x >> 16;
	return float(x >> 8) * (1.0 / 16777216.0);
}

float chance(candidate c, uint salt)
{
	return chance_by(c, copy * SALTS + salt);
}

float around_zero(candidate c, uint salt)
{
	return 2.0 * chance(c, salt) - 1.0;
}

vec3 ray_of(candidate c)
{
	return vec3((c.at - lens.yz) / lens.x * rays.x, 1.0);
}

bool is_hatching()
{
	return hatch_way.w > 0.0;
}

/* Of a chunk of leaves, which stand any way. */
bool is_leaf(candidate c)
{
	return views[c.view].crown.w < 0.0 && points[c.index].z >> 24 == UNDIRECTED;
}

float cosine_of(candidate c, vec3 normal)
{
	if (paint_size.x > 0.0 && is_leaf(c))
		return COSINE_UNKNOWN;
	if (is_hatching() && points[c.index].z >> 24 == UNDIRECTED)
		return COSINE_UNKNOWN;
	if ((c.kind == UNDIRECTED && which.y == 0u) || normal == vec3(0.0))
		return COSINE_UNKNOWN;
	return max(abs(dot(normal, ray_of(c))), COSINE_LEAST);
}

line line_of(candidate c)
{
	line l;
	uint bits = looks[c.index].y;
	l.is_there = false;
	if ((bits & 0xffffu) == NO_DIRECTION)
		return l;
	vec3 d = turned(bits), ray = ray_of(c);
	float scale = lens.x / scale_m(c.depth_m);
	vec2 over = (d.xy - ray.xy * d.z) * scale;
	l.px_per_m = length(over);
	l.is_there = l.px_per_m > 1e-3 * scale;
	l.along = over / l.px_per_m;
	l.slope = -d.z / (c.depth_m * c.depth_m * l.px_per_m);
	return l;
}

uint lightness_of(uint rgba)
{
	uint sum = 77u * (rgba & 255u) + 150u * (rgba >> 8 & 255u) + 29u * (rgba >> 16 & 255u) + 128u;
	return rgba >> 24 != 0u ? sum >> 8 : 128u;
}

bool is_on_edge(uint kind)
{
	return kind == DIRECTED && which.y == 0u;
}

bool is_contours()
{
	return contour.x > 0.0;
}

bool is_cut()
{
	return cut.x > 0.0;
}

/* All points are surface to it, in the order of their own ranks. */
bool is_whole()
{
	return is_hatching() || is_contours() || is_cut() || paint_size.x > 0.0;
}

/* Of dithering points without all others on surface: how far apart black ones are; else 0. */
float dither_m(uint n, uint kind)
{
	float per_m2 = own_way.z * uintBitsToFloat(views[n].pipeline.w);
	return kind == DITHER && per_m2 > 0.0 ? 1.0 / sqrt(per_m2) : 0.0;
}

/* frame_layer_has_surface() */
bool has_surface(uint kind)
{
	return kind < UNDIRECTED || (which.x >> (8u + kind) & 1u) != 0u;
}

/* As dense as all points are, and dithering points no denser than that. */
bool has_own_spacing(uint kind)
{
	return !is_whole() && (which.x >> (8u + kind) & 1u) == 0u && (kind != DITHER || own_way.z == 0.0);
}

/* Of the longest ray of depth 1. */
float ray_most()
{
	return length(vec3((lens.yz + shape.x / 2.0) / lens.x * rays.x, 1.0));
}

/* That a point fades in over, and what need must be more for them: STROKE_FADE_NEAR_M, STROKE_FADE_MOST and STROKE_FADE_MORE (stroke.h). */
const float FADE_NEAR_M = 21.5, FADE_MOST = 5.66;
float octaves_at(float depth_m)
{
	return clamp(FADE_NEAR_M / depth_m, 1.0, FADE_MOST);
}

float more_of(float octaves)
{
	float more = octaves - 1.0;
	return 1.0 + more * (0.307 + more * (0.028 - 0.0015 * more));
}

/* Strokes wanted to a square pixel where a surface of that colour is seen from the front. */
float wanted_at(candidate c, vec3 normal)
{
	uint n = lightness_of(looks[c.index].x);
	float light_left = 1.0;
	if (texels.w == LIT_TONE)
		n = uint(float(n) * lit_of(normal));
	if (texels.w == LIT_OMITTED)
		light_left = 1.0 - light_from.w * diffuse_of(normal);
	return wanted_per_px[n >> 2][n & 3u] * light_left;
}

/* From the focus. */
float away_from(candidate c)
{
	return away_of(seen_place(c.at, c.depth_m), colour.w != 0u);
}

/* The same to a square metre of it. */
float need_on_surface(float wanted, float depth_m, float cosine)
{
	float px_per_m = lens.x / scale_m(depth_m);
	return wanted * px_per_m * px_per_m * cosine;
}

float need_along(candidate c, line l)
{
	return l.px_per_m * c.spacing_m / (shape.z * FADE_MEAN);
}

/* Points to a square metre before it, and the last one's. Copies come after all points. */
vec2 place_in_queue(candidate c)
{
	float last = 1.0 / (c.spacing_m * c.spacing_m), rank = c.rank * last;
	if (which.y != 0u) {
		uint n = lightness_of(looks[c.index].x);
		float spacing_m = float(points[c.index].y >> 16) * UNIT_M;
		last = 1.0 / (spacing_m * spacing_m);
		float there = min(dithering_per_m2[n >> 2][n & 3u] * uintBitsToFloat(views[c.view].pipeline.w), last);
		rank = c.kind == DITHER ? c.rank * there : there + c.rank * (last - there);
	}
	return vec2(rank, last);
}

/* How much larger strokes must be where need is more than there are points for. */
float growth_of(float need)
{
	float part = need / 2.0, mean = 1.0;
	if (need <= 1.0)
		return 1.0;
	if (need < 2.0) /* the mean of fade_of over all ranks */
		mean = part + (1.0 - part) * (log2(need) + 1.0 / 0.69314718) + part * log2(part);
	return sqrt(need * FADE_MEAN / mean);
}

/* Along each of two axes, in diameters of the patch: how far strokes are moved from their points. */
float reach_of(bool is_copy)
{
	return look.y * (is_copy ? COPY_REACH : 1.0) / 2.0;
}

/* Of all copies. */
float moved_most(uint n, uint kind)
{
	return has_surface(kind) ? views[n].splat.w * reach_of(colour.z > 1u) * 1.41421356 : 0.0;
}

/* Where strokes of points at this depth may be. */
float nearest_of(uint n, uint kind, float depth_m)
{
	return max(depth_m - moved_most(n, kind), lens.w);
}

/* Moves the point in its plane, inside the patch that it stands for. */
void scatter(inout candidate c)
{
	vec3 normal = unpacked(points[c.index].w);
	float facing = normal.z >= 0.0 ? 1.0 : -1.0, s = -1.0 / (facing + normal.z);
	float t = normal.x * normal.y * s;
	vec3 across = vec3(1.0 + facing * normal.x * normal.x * s, facing * t, -facing * normal.x);
	vec3 down = vec3(t, facing + normal.y * normal.y * s, -normal.y);
	float reach_m = reach_of(copy != 0u) * float(points[c.index].z & 0x7fffu) * UNIT_M;
	vec2 at_patch = vec2(chance_by(c, SALT_ACROSS), chance_by(c, SALT_DOWN)) + fract(float(copy) * COPY_STEPS);
	at_patch = 2.0 * (at_patch - step(1.0, at_patch)) - 1.0;
	vec3 by = reach_m * (at_patch.x * across + at_patch.y * down);
	vec3 at = seen_place(c.at, c.depth_m) + to_camera(by);
	if (at.z < lens.w)
		return;
	c.depth_m = at.z;
	c.at = lens.yz + lens.x * at.xy / scale_m(at.z);
}

float fade_of(float rank, float need, float octaves)
{
	return rank >= need ? 0.0 : min(log2(need / rank) / octaves, 1.0);
}

const float HIDDEN_BEHIND = 0.03;

float shows(ivec2 at, float depth_m)
{
	at = clamp(at, ivec2(0), ivec2(size.xy) - 1);
	float behind = (depth_m / mask_depth(texelFetch(mask_keys, at, 0).r) - 1.0) * stretch(depth_m);
	return clamp(1.0 - behind * (1.0 / HIDDEN_BEHIND), 0.0, 1.0);
}

/* How far it is not hidden in the four pixels around. */
float visibility(candidate c)
{
	vec2 at = c.at - 0.5, low = floor(at), u = at - low;
	ivec2 p = ivec2(low);
	return (1.0 - u.y) * ((1.0 - u.x) * shows(p, c.depth_m) +
				     u.x * shows(p + ivec2(1, 0), c.depth_m)) +
	       u.y * ((1.0 - u.x) * shows(p + ivec2(0, 1), c.depth_m) +
			     u.x * shows(p + ivec2(1, 1), c.depth_m));
}

float opacity_of(candidate c)
{
	float degree = float(points[c.index].z >> 16 & 255u) / 255.0;
	float alpha = opacity.x * (1.0 - opacity.y * chance(c, SALT_OPACITY));
	alpha *= 1.0 - opacity.z * (1.0 - degree);
	return opacity.w > 0.0 ? alpha * exp2((rays.w - c.depth_m) / opacity.w) : alpha;
}

/* Need is this * (pixels to its spacing)^2 at most; along edges it is not squared. */
float need_once(uint kind)
{
	return ray_most() * (is_on_edge(kind) ? 1.0 / (shape.z * FADE_MEAN) : wanted_most[kind]);
}

/* No rank of the kind above it is drawn of the view. */
float need_most(uint n, uint kind)
{
	float spacing_most_m = has_own_spacing(kind) ? views[n].spacing_most_m[kind] : max(views[n].splat.z, dither_m(n, kind));
	float nearest_m = nearest_of(n, kind, views[n].base.w), near = lens.x / scale_m(nearest_m) * spacing_most_m;
	return need_once(kind) * (is_on_edge(kind) ? near : near * near) * more_of(octaves_at(nearest_m));
}

/* Where the entries of each kind begin; and before which of them all end that candidate_of() may take. */
void asked_of(uint n, out uvec4 begin_of, out uvec4 end_of)
{
	uvec4 end = is_whole() ? uvec4(views[n].at.z) : views[n].kind_end;
	begin_of = end_of = uvec4(0u);
	if ((views[n].at.w & NO_STROKES) != 0u)
		return;
	begin_of = uvec4(0u, end.xyz);
	for (uint kind = 0u; kind < 4u; kind++) {
		uint many = end[kind] - begin_of[kind];
		bool is_drawn = is_whole() || (which.x >> kind & 1u) != 0u;
		if (!is_drawn || many == 0u)
			many = 0u;
		else if (!is_cut())
			many = uint(min(need_most(n, kind) * float(many) + 2.5, float(many)));
		end_of[kind] = begin_of[kind] + many;
	}
}

/* scene_list_spacing_m() to that of all points. */
float farther_of(uint n, uint kind, uint entry)
{
	float along = kind == DIRECTED ? 1.0 / (LIST_RIDGE * sqrt(uintBitsToFloat(views[n].pipeline.w))) : 1.0;
	return along * uintBitsToFloat(LIST_NEAR + (entry >> 24) * LIST_STEP);
}

/* Entry i of the list of view n, if its kind is drawn and it is in the picture. */
bool candidate_of(uint n, uint i, out candidate c)
{
	uvec4 end = views[n].kind_end;
	if (is_whole())
		end = uvec4(views[n].at.z);
	c.kind = i < end.x ? 0u : i < end.y ? 1u : i < end.z ? 2u : 3u;
	if (i >= end.w || (!is_whole() && (which.x >> c.kind & 1u) == 0u))
		return false;
	uint from = c.kind == 0u ? 0u : end[c.kind - 1u];
	float many = float(end[c.kind] - from);
	c.rank = (float(i - from) + 0.5) * (1.0 / many);
	if (!is_cut() && c.rank > need_most(n, c.kind) + 1.0 / many)
		return false;
	uint word = is_whole() ? i : lists[views[n].at.x + i];
	c.index = views[n].at.x + (word & 0xfffu);
	c.point = views[n].at.y + (word & 0xfffu);
	if (is_whole() && !is_contours() && (which.x >> (points[c.index].z >> 24) & 1u) == 0u)
		return false;
	c.view = n;
	c.spacing_m = float(points[c.index].y >> 16) * UNIT_M;
	if (has_own_spacing(c.kind))
		c.spacing_m *= farther_of(n, c.kind, word);
	if (!is_whole())
		c.spacing_m = max(c.spacing_m, dither_m(n, c.kind));
	vec3 at = place_of(n, points[c.index]);
	float nearest_m = nearest_of(n, c.kind, at.z), px_per_m = lens.x / scale_m(nearest_m),
	      scale = lens.x / scale_m(at.z);
	/* What moves ahead moves aside too, where it is seen aslant. */
	float around = shape.x / 2.0 + moved_most(n, c.kind) * ray_most() * px_per_m;
	c.at = lens.yz + at.xy * scale;
	c.depth_m = at.z;
	if (is_cut()) /* which of them, cut.glsl tells */
		return true;
	float here = c.spacing_m * px_per_m;
	float need = need_once(c.kind) * (is_on_edge(c.kind) ? here : here * here) * more_of(octaves_at(nearest_m));
	return at.z > lens.w && at.z <= cuts.z && all(greaterThanEqual(c.at, vec2(-around))) &&
	       all(lessThan(c.at, size.xy + around)) && c.rank < need;
}

const float TURNED_AWAY = 0.1, HATCH_TURNED_AWAY = 0.3;

/* How far it is drawn where backs are hidden. */
float facing(candidate c, vec3 normal)
{
	if (views[c.view].mask.w <= 0.0 || normal == vec3(0.0))
		return 1.0;
	float whole = is_hatching() ? HATCH_TURNED_AWAY : TURNED_AWAY;
	return clamp(dot(normal, ray_of(c)) * (-1.0 / whole), 0.0, 1.0);
}

bool goes_along(candidate c)
{
	return (which.z >> c.kind & 1u) != 0u;
}

choice choice_on_edge(candidate c)
{
	choice one;
	float away = away_from(c);
	one.growth = 1.0 + focus_reach.z * away;
	one.edge = line_of(c);
	one.normal = turned(points[c.index].w);
	one.lit = lit_of(one.normal);
	one.alpha = visibility(c) * facing(c, one.normal) * (1.0 - focus.w * away);
	if (one.alpha <= 0.0 || !one.edge.is_there)
		one.alpha = 0.0;
	else {
		float octaves = octaves_at(c.depth_m);
		one.alpha *= fade_of(c.rank, need_along(c, one.edge) * more_of(octaves) / one.growth, octaves);
	}
	one.edge.is_there = one.edge.is_there && goes_along(c);
	return one;
}

