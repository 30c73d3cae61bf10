/* edl_deeper() and edl_light() (edl.h). than: how much deeper the pixel is than what is on one half of the ring, and opposite of that. */
float edl_light(float strength, vec2 than[4], float depth_m, float spacing_m, float radius_px)
{
	float apart = spacing_m * lens.x / scale_m(depth_m) / radius_px, slant = 0.0, sum = 0.0;
	for (int n = 0; n < 4; n++)
		slant = max(slant, min(abs(than[n].x), abs(than[n].y)));
	for (int n = 0; n < 4; n++) {
		vec2 over = max(than[n] - apart * slant, 0.0);
		sum += over.x + over.y;
	}
	return exp(-300.0 * 0.1 * strength * sum / 8.0);
}
