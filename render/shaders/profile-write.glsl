#version 310 es
/* Writes links as strokes, those that are not seen as nothing (profile-strokes.c). */
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer Shown {
	float shown[];
};
layout(std430, binding = 6) writeonly buffer Strokes {
	uint strokes[];
};
const uint WORDS = 10u, AROUND = 4u;
/* In front of all that the mask has: what is seen was decided here. */
const float NEAR = 1e20;
const float SEEN_FROM = 0.3, SEEN_RISE = 3.0, TIP = 0.2, LAP_PX = 0.5, ALPHA_LEAST = 1.0 / 255.0;

/* As far as it is shown, or most around it in its chain are. */
float seen_at(uint n)
{
	float sum = shown[n], count = 1.0;
	uint at = n;
	for (uint k = 0u; k < AROUND && (flags_of(at) & FIRST) == 0u; k++, count += 1.0)
		sum += shown[--at];
	at = n;
	for (uint k = 0u; k < AROUND && (flags_of(at) & LAST) == 0u; k++, count += 1.0)
		sum += shown[++at];
	return max(shown[n], clamp((sum / count - SEEN_FROM) * SEEN_RISE, 0.0, 1.0));
}

/* How many links it is to where its run of the pen ends; lift: as many or more. */
uint links_to_end(uint n)
{
	uint before = n, behind = n;
	for (uint away = 0u; away < lift; away++) {
		if (seen_at(before) < 0.5 || seen_at(behind) < 0.5)
			return away;
		uint here = flags_of(before), there = flags_of(behind);
		if ((here & (FIRST | BEGINS)) == (FIRST | BEGINS) || (there & (LAST | ENDS)) == (LAST | ENDS))
			return away;
		before -= (here & FIRST) == 0u ? 1u : 0u;
		behind += (there & LAST) == 0u ? 1u : 0u;
	}
	return lift;
}

float taper(float away)
{
	float part = min((away + 0.5) / (float(lift) + 0.5), 1.0);
	return TIP + (1.0 - TIP) * part * (2.0 - part);
}

void main()
{
	uint n = first_count.x + gl_GlobalInvocationID.x;
	if (n >= first_count.y)
		return;
	link l = links[n];
	float seen = seen_at(n), long_px = length(l.pen.zw);
	float alpha = l.look.x * seen + l.look.y * (1.0 - seen);
	vec2 end = (long_px > 0.0 ? l.pen.zw / long_px : vec2(1.0, 0.0)) * (long_px + LAP_PX);
	float half_width = l.place.w * taper(float(links_to_end(n)));
	bool is_drawn = alpha >= ALPHA_LEAST;
	float word[9] = float[9](is_drawn ? l.pen.x : -1e6, l.pen.y, end.x, end.y, half_width, alpha, NEAR, 0.0, 0.0);
	for (uint k = 0u; k < 9u; k++)
		strokes[n * WORDS + k] = floatBitsToUint(word[k]);
	strokes[n * WORDS + 9u] = colour.x & 0xffffffu;
}
