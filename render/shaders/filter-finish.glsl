#version 310 es
/* filter_finish_part() */
void main()
{
	ivec2 p;
	if (!is_here(p))
		return;
	int at = at_of(p);
	float weight = weight_at(at) * acting.z - acting.w;
	int part = int(clamp(weight, 0.0, 1.0) * 256.0 + 0.5);
	uint was = pixels[at], is = spare[at], mixed = OPAQUE;
	for (int k = 0; k < 24; k += 8) {
		int before = int(was >> k & 255u), after = int(is >> k & 255u);
		mixed |= uint(before + (((after - before) * part + 128) >> 8)) << k;
	}
	spare[at] = mixed;
}
