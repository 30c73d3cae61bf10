#version 310 es
/* Noise that sticks to the site (filter_noise), into plane b, by the calm depths in a. by: grain_px; then of each octave where in its cell the eye is. whole: that
 * cell; behind them the seed. */
const int LOWEST = -24, OCTAVES = 48;

vec3 eased(vec3 t)
{
	return t * t * t * (t * (6.0 * t - 15.0) + 10.0);
}

uint mixed(uint u)
{
	u ^= u >> 15;
	u *= 0x2c1b3c6du;
	u ^= u >> 12;
	u *= 0x297a2d39u;
	return u ^ u >> 15;
}

/* Of the corner's slope, one of the eight diagonals. */
float corner(uint hash, vec3 from)
{
	return ((hash & 4u) != 0u ? -from.x : from.x) + ((hash & 2u) != 0u ? -from.y : from.y) +
	       ((hash & 1u) != 0u ? -from.z : from.z);
}

float noise_in(ivec3 cell, vec3 within, uint seed)
{
	const uvec3 factor = uvec3(0x8da6b343u, 0xd8163841u, 0xcb1ab31fu);
	uvec3 low = uvec3(cell) * factor, high = low + factor;
	float of[8];
	for (int n = 0; n < 8; n++) {
		ivec3 bit = ivec3(n & 1, n >> 1 & 1, n >> 2);
		uint h = (bit.x != 0 ? high.x : low.x) ^ (bit.y != 0 ? high.y : low.y) ^
			 (bit.z != 0 ? high.z : low.z) ^ seed;
		of[n] = corner(mixed(h), within - vec3(bit));
	}
	vec3 t = eased(within);
	float upper = mix(mix(of[0], of[1], t.x), mix(of[2], of[3], t.x), t.y);
	return 0.78 * mix(upper, mix(mix(of[4], of[5], t.x), mix(of[6], of[7], t.x), t.y), t.z);
}

float octave_of(vec3 from_m, int octave)
{
	vec3 place = from_m * exp2(-float(octave)) + by[1 + octave - LOWEST].xyz;
	ivec3 low = ivec3(floor(place));
	return noise_in(low + whole[octave - LOWEST].xyz, place - vec3(low),
		uint(octave + 64) * 0x9e3779b9u + uint(whole[OCTAVES].x));
}

/* Where nothing is, noise of the picture. */
float flat_noise(vec2 at)
{
	vec3 place = vec3(at / by[0].x, 0.5);
	ivec3 low = ivec3(floor(place));
	return noise_in(low, place - vec3(low), uint(whole[OCTAVES].x));
}

void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	float near_m = a[at];
	if (near_m >= FAR) {
		b[at] = flat_noise(vec2(p + area.zw + window.xy));
		return;
	}
	float octave = clamp(log2(scale_m(near_m) * (by[0].x / lens.x)), float(LOWEST), float(LOWEST + OCTAVES - 2));
	int low = int(floor(octave));
	float part = octave - float(low);
	vec3 from_m = from_eye_m(p, near_m);
	float fine = octave_of(from_m, low), coarse = octave_of(from_m, low + 1);
	b[at] = mix(fine, coarse, part) / sqrt(part * part + (1.0 - part) * (1.0 - part));
}
