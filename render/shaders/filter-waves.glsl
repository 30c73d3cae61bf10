#version 310 es
/* Waves in the site (filter_waves), in metres, into plane b, by the calm depths in a. by: shortest_px; then of each which way it goes, and how
 * much of it is behind where the eye is. */
const int LOWEST = -12, WAVES = 20;

/* Of a whole turn, in its part of it. */
float sine_of_turn(float turns)
{
	float part = turns - floor(turns + 0.5), bow = 8.0 * part - 16.0 * part * abs(part);
	return bow * (0.775 + 0.225 * abs(bow));
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	float depth_m = a[at], sum = 0.0;
	if (depth_m < FAR) {
		float octave = log2(scale_m(depth_m) * (by[0].x / lens.x));
		vec3 from_m = from_eye_m(p, depth_m);
		for (int n = clamp(int(floor(octave)) - LOWEST, 0, WAVES); n < WAVES; n++) {
			float of = float(n + LOWEST), there = clamp(of + 1.0 - octave, 0.0, 1.0);
			sum += there * exp2(of) * sine_of_turn(dot(by[1 + n].xyz, from_m) * exp2(-of) + by[1 + n].w);
		}
	}
	b[at] = sum;
}
