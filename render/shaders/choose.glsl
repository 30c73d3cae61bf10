/* Which points of a layer become strokes: the rules of stroke.c. */
layout(std430, binding = 3) readonly buffer Looks {
	uvec2 looks[]; /* rgba, direction */
};
layout(std430, binding = 4) readonly buffer Lists {
	uint lists[]; /* index in the chunk, list_spacing */
};
/* Of each view of the layer: a word of each thread, whose bits are its points that are drawn; and how many there are in all, then
 * how many there are before. One more at the end. */
layout(std430, binding = 5) buffer Marks {
	uint marks[];
};
layout(location = 1) uniform uint layer_view;

const uint THREADS = 256u, MARKS = 257u;
const uint DITHER = 1u, UNDIRECTED = 2u, DIRECTED = 3u;
const float COSINE_LEAST = 0.05, COSINE_UNKNOWN = 0.5, FORESHORTENED = 0.25;
const float ALPHA_LEAST = 1.0 / 255.0, FADE_MEAN = 0.7213;
const uint NO_DIRECTION = 0x8000u;

struct candidate {
	uint kind, index, point; /* in the slab, in the scene */
	float rank, spacing_m;
	vec2 at;
	float depth_m;
};

struct line {
	bool is_there;
	vec2 along;
	float px_per_m, slope;
};

float chance(uint point, uint salt)
{
	uint x = point * 0x9E3779B9u ^ salt * 0x85EBCA6Bu;
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	x ^= x >> 16;
	return float(x >> 8) * (1.0 / 16777216.0);
}

vec3 ray_of(candidate c)
{
	return vec3((c.at - lens.yz) / lens.x, 1.0);
}

float cosine_of(candidate c, vec3 normal)
{
	if (normal == vec3(0.0))
		return COSINE_UNKNOWN;
	vec3 ray = ray_of(c);
	return max(abs(dot(normal, ray)) / length(ray), COSINE_LEAST);
}

line line_of(candidate c)
{
	line l;
	uint bits = looks[c.index].y;
	l.is_there = false;
	if ((bits & 0xffffu) == NO_DIRECTION)
		return l;
	vec3 d = turned(bits), ray = ray_of(c);
	float scale = lens.x / c.depth_m;
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

/* Strokes wanted over points that there are. */
float need_on_surface(candidate c, float cosine)
{
	uint n = lightness_of(looks[c.index].x);
	float px_per_m = lens.x / c.depth_m;
	float wanted_per_m2 = wanted_per_px[n >> 2][n & 3u] * px_per_m * px_per_m * cosine;
	float there = dithering_per_m2[n >> 2][n & 3u];
	if (which.y != 0u && c.kind == DITHER)
		return wanted_per_m2 / there;
	if (which.y != 0u)
		wanted_per_m2 = max(wanted_per_m2 - there, 0.0);
	return wanted_per_m2 * c.spacing_m * c.spacing_m;
}

float fade_of(float rank, float need)
{
	return rank >= need ? 0.0 : min(log2(need / rank), 1.0);
}

float shows(ivec2 at, float depth_m)
{
	at = clamp(at, ivec2(0), ivec2(size.xy) - 1);
	return depth_m <= mask_depth(texelFetch(mask_keys, at, 0).r) ? 1.0 : 0.0;
}

/* Part of the four pixels around that it is not hidden in. */
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
	float alpha = opacity.x * (1.0 - opacity.y * chance(c.point, 3u));
	alpha *= 1.0 - opacity.z * (1.0 - degree);
	return opacity.w > 0.0 ? alpha * exp2(-c.depth_m / opacity.w) : alpha;
}

/* Entry i of the list of view n, if its kind is drawn and it is in the picture. */
bool candidate_of(uint n, uint i, out candidate c)
{
	uvec4 end = views[n].kind_end;
	c.kind = i < end.x ? 0u : i < end.y ? 1u : i < end.z ? 2u : 3u;
	if (i >= end.w || (which.x >> c.kind & 1u) == 0u)
		return false;
	uint from = c.kind == 0u ? 0u : end[c.kind - 1u];
	float many = float(end[c.kind] - from);
	c.rank = (float(i - from) + 0.5) * (1.0 / many);
	float near = lens.x / views[n].base.w * views[n].spacing_most_m[c.kind];
	float most = c.kind == DIRECTED ? near / (shape.z * FADE_MEAN) : wanted_most[c.kind] * near * near;
	if (c.rank > most + 1.0 / many)
		return false;
	uint word = lists[views[n].at.x + i];
	c.index = views[n].at.x + (word & 0xffffu);
	c.point = views[n].at.y + (word & 0xffffu);
	c.spacing_m = float(word >> 16) * UNIT_M;
	vec3 at = place_of(n, points[c.index]);
	float around = shape.x / 2.0, scale = lens.x / at.z;
	c.at = lens.yz + at.xy * scale;
	c.depth_m = at.z;
	float here = c.spacing_m * scale;
	float need = c.kind == DIRECTED ? here * (1.0 / (shape.z * FADE_MEAN)) : here * here * wanted_most[c.kind];
	return at.z > lens.w && all(greaterThanEqual(c.at, vec2(-around))) &&
	       all(lessThan(c.at, size.xy + around)) && c.rank < need;
}

/* How opaque it is; 0: it is not drawn. */
float alpha_of(candidate c, out line edge, out vec3 normal)
{
	edge.is_there = false;
	if (c.kind != DIRECTED && c.rank >= need_on_surface(c, 1.0))
		return 0.0;
	float shown = visibility(c);
	if (shown <= 0.0)
		return 0.0;
	normal = turned(points[c.index].w);
	if (c.kind == DIRECTED)
		edge = line_of(c);
	float need = edge.is_there ? edge.px_per_m * c.spacing_m / (shape.z * FADE_MEAN)
				   : need_on_surface(c, cosine_of(c, normal));
	float alpha = opacity_of(c) * fade_of(c.rank, need) * shown;
	return alpha < ALPHA_LEAST ? 0.0 : alpha;
}
