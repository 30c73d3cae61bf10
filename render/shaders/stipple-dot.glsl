/* A point as a dot. */
const float ALPHA_LEAST = 1.0 / 255.0;

/* at: as the camera sees it. 0: nothing is drawn. */
float alpha_of(uint n, uint i, out vec3 at)
{
	uint spot;
	at = vec3(0.0);
	if (!spot_of(n, i, spot) || spots[spot + ANSWER] == NOT_DRAWN)
		return 0.0;
	at = place_of(n, points[views[n].at.x + i]);
	float light_left = spots[spot + ANSWER] == LEFT_OUT ? 1.0 - light_from.w : 1.0;
	float alpha = opacity.x * light_left * (1.0 - focus.w * away_of(at, colour.w != 0u));
	return alpha < ALPHA_LEAST ? 0.0 : alpha;
}

/* asked_of() of choose.glsl: of all points it must be asked. */
void asked_of(uint n, out uvec4 begin_of, out uvec4 end_of)
{
	begin_of = uvec4(0u);
	end_of = uvec4(views[n].at.z, uvec3(0u));
}

uint strokes_at(uint n, uint i)
{
	vec3 at;
	return alpha_of(n, i, at) > 0.0 ? 1u : 0u;
}
