#version 310 es
/* Means along what the picture shows, or across it (filter-trace.h): of pixels into spare ones, or of plane a into plane b. Plane c has
 * what runs where. */
const int MEAN = 0, SUM = 1;

struct traced {
	vec3 of;
	float weight, weight2;
};
BETWEEN(between_a, a)

float weight_of(int k)
{
	return by[k >> 2][k & 3];
}

vec2 way_at(vec2 p)
{
	ivec2 at = nearest(p) >> 1;
	int n = 3 * (at.y * whole[1].x + at.x);
	return vec2(c[n], c[n + 1]);
}

void add(vec2 p, float weight, inout traced t)
{
	t.weight += weight;
	t.weight2 += weight * weight;
	if (whole[0].w != 0)
		t.of += weight * rgb_of(pixels[at_of(nearest(p))]);
	else
		t.of.x += weight * between_a(area.xy, p);
}

void walk(vec2 p, vec2 way, inout traced t)
{
	for (int n = 1; n <= whole[0].x; n++) {
		if (whole[0].z == 0 && n > 1) {
			vec2 next = way_at(p);
			/* Directions have no sign of their own. */
			way = dot(next, way) < 0.0 ? -next : next;
		}
		p += way;
		if (any(lessThan(p, vec2(0.0))) || any(greaterThan(p, vec2(area.xy - 1))))
			break;
		add(p, weight_of(n), t);
	}
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	traced t = traced(vec3(0.0), 0.0, 0.0);
	vec2 way = way_at(vec2(p));
	if (whole[0].z != 0)
		way = vec2(-way.y, way.x);
	add(vec2(p), weight_of(0), t);
	walk(vec2(p), way, t);
	walk(vec2(p), -way, t);
	float part = whole[0].y == MEAN ? 1.0 / t.weight : whole[0].y == SUM ? 1.0 : inversesqrt(t.weight2);
	if (whole[0].w != 0)
		spare[at_of(p)] = rgba_of(t.of * part);
	else
		b[at_of(p)] = t.of.x * part;
}
