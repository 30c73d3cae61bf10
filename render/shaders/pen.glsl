/* A stroke, ready to be drawn, and what it leaves in a pixel (band_ink). */
const float COVERS = 0.25, PLANE_ROUGH = 0.6, ROUGH_MOST = 0.06, LAYS = 64.0, REACH_MOST = 0.5;

struct pen {
	vec4 place;  /* x y, cosine, sine */
	vec4 body;   /* half_length, half_width, alpha, variant */
	vec3 plane;  /* 1/depth: q, slope */
	vec3 colour; /* linear */
	vec4 lay;    /* of paint: octaves that it lies high, how thick it must be; from where and to where it reaches */
};

/* As choose-write.glsl writes strokes: x y, from its middle to its end; half_width, alpha, q, slope to the right and down; rgb and variant. */
pen pen_of(vec4 place, vec4 body, float slope_down, uint rgb_variant)
{
	pen p;
	float half_length = length(place.zw);
	p.place = vec4(place.xy, half_length > 0.0 ? place.zw / half_length : vec2(1.0, 0.0));
	p.body = vec4(half_length, body.xy, float(rgb_variant >> 24));
	p.plane = vec3(body.zw, slope_down);
	p.colour = light_of_bytes(rgb_variant);
	p.lay = vec4(0.0);
	if (colour.y == LAID) {
		vec2 reach = abs(p.place.zw) * half_length + abs(p.place.wz) * body.x;
		float slack = min(PLANE_ROUGH * dot(abs(p.plane.yz), reach) / p.plane.x, ROUGH_MOST);
		p.body.w = float(rgb_variant >> 24 & 3u);
		float dry = 1.0 - body.y;
		p.lay = vec4(float(rgb_variant >> 26) * paint_lay.x - 0.5 * (paint_lay.x * (LAYS - 1.0) + paint_lay.y),
			dry * dry * dry, 1.0 - slack, paint_lay.z + paint_lay.w * p.plane.x + slack);
	}
	return p;
}

/* Along and across: no pixel farther from its middle has ink. */
vec2 reach_of(pen p)
{
	return ink_reach(p.body.x, p.body.y) + 1.0 / 64.0;
}

/* Of the kernel alone. */
float thick_at(pen p, vec2 from)
{
	return ink_alpha(vec2(dot(from, p.place.zw), from.y * p.place.z - from.x * p.place.w), p.body);
}

float q_at(pen p, vec2 from)
{
	return p.plane.x + dot(from, p.plane.yz);
}

/* 0 where it is hidden. middle: of the pixel, here and below. */
float alpha_at(pen p, vec2 middle)
{
	vec2 from = middle - p.place.xy;
	float alpha = thick_at(p, from) * p.body.z;
	uint key = texelFetch(mask_keys, ivec2(middle), 0).r;
	float shows_from = 1.0 - min(own_way.w * p.plane.x, REACH_MOST);
	return q_at(p, from) * uintBitsToFloat(key) < shows_from ? 0.0 : alpha;
}

/* What that much leaves of what is below, of each channel. */
vec3 left_by(pen p, float alpha)
{
	return 1.0 - alpha * (1.0 - p.colour);
}

/* ---- paint ---- */

/* 2^x, and what is between whole powers on straight lines. */
float power_of_two(float x)
{
	return uintBitsToFloat(uint((x + 127.0) * 8388608.0));
}

bool is_reached(pen p, float q, uint key)
{
	float behind = q * uintBitsToFloat(key);
	return behind >= p.lay.z && behind <= p.lay.w;
}

/* What is outside of the mask is empty. */
bool is_reached_there(pen p, float q, ivec2 at)
{
	bool is_in = all(greaterThanEqual(at, ivec2(0))) && all(lessThan(at, ivec2(size.xy)));
	return is_reached(p, q, is_in ? texelFetch(mask_keys, at, 0).r & 0xffffff00u : MASK_EMPTY);
}

/* At half the way to beyond a hole, or at all of it. */
bool is_reached_beside(pen p, float q, ivec2 at, ivec2 way)
{
	int far = int(paint_hole.x), half_way = (far + 1) / 2;
	return is_reached_there(p, q, at + half_way * way) || is_reached_there(p, q, at + far * way);
}

/* Where paint may be: on what it reaches, and on small holes in that. */
bool takes_paint(pen p, float q, ivec2 at)
{
	const ivec2 right = ivec2(1, 0), down = ivec2(0, 1);
	uint key = texelFetch(mask_keys, at, 0).r;
	if (is_reached(p, q, key) || key < MASK_EMPTY)
		return is_reached(p, q, key);
	return (is_reached_beside(p, q, at, -right) && is_reached_beside(p, q, at, right)) ||
	       (is_reached_beside(p, q, at, -down) && is_reached_beside(p, q, at, down));
}

/* How much it covers, how many octaves its weight is high, how thick it is. */
bool is_laid_at(pen p, vec2 middle, out vec3 laid)
{
	vec2 from = middle - p.place.xy;
	float thick = thick_at(p, from), cover = clamp((thick - p.lay.y) * (1.0 / COVERS), 0.0, 1.0);
	laid = vec3(cover, p.lay.x + paint_lay.y * thick, thick);
	return cover > 0.0 && takes_paint(p, q_at(p, from), ivec2(middle));
}
