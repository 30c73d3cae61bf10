/* Points as discs of their own projected size: the rules of disc-lanes.h. */
const float DISC_CROWD = 5.0;
const float DISC_RADIUS_MOST = 48.0;
const float DISC_STEEPEST = 40.0;
const float DISC_ROUNDING = 1e-3;

struct disc {
	vec2 at;
	float radius, depth_m, rank;
	vec2 squash, tilt;
	ivec4 box; /* of pixels: left, top, right, bottom */
};

/* Whether it shows: not where backs are hidden and it is one. */
bool tilt_disc(uvec4 p, float radius_least, bool backs_hidden, inout disc d)
{
	vec3 n = turned(p.w);
	vec2 ray = (d.at - lens.yz) * (rays.x / lens.x);
	float aside2 = dot(n.xy, n.xy);
	d.squash = vec2(0.0);
	d.tilt = vec2(0.0);
	float along = dot(n.xy, ray) + n.z;
	if (backs_hidden && along > 0.0)
		return false;
	if (!(aside2 > 1e-6))
		return true;
	float cosine2 = along * along / (dot(ray, ray) + 1.0);
	float flat2 = radius_least * radius_least / (d.radius * d.radius);
	cosine2 = min(max(max(cosine2, flat2), 1e-3), 1.0);
	d.squash = sqrt((1.0 / cosine2 - 1.0) / aside2) * n.xy;
	float steep = max(abs(along) * lens.x, sqrt(aside2) * max(d.radius * 3.0, lens.x / DISC_STEEPEST));
	d.tilt = (along >= 0.0 ? -1.0 : 1.0) * scale_m(d.depth_m) / steep * n.xy;
	return true;
}

/* How many of the first points of a view may be drawn. */
uint disc_end(uint n)
{
	return views[n].at.w & ~(PLANES_STAND | NO_STROKES);
}

/* Point i of view n, if it is drawn here: not where a plane stands for it. */
bool disc_of(uint n, uint i, float factor, float radius_least, out disc d)
{
	uvec4 p = points[views[n].at.x + i];
	if ((views[n].at.w & PLANES_STAND) != 0u && (p.z >> 15 & 1u) != 0u)
		return false;
	vec3 at = place_of(n, p);
	float deep = scale_m(at.z), scale = lens.x / deep;
	float spacing_px = float(p.y >> 16) * (UNIT_M * lens.x) / deep;
	float disc_px = float(p.z & 0x7fffu) * (UNIT_M * lens.x) / deep;
	float rank = (float(i) + 0.5) * (1.0 / float(views[n].at.z));
	float part = min(spacing_px * spacing_px * DISC_CROWD, 1.0);
	d.at = lens.yz + at.xy * scale;
	d.depth_m = at.z;
	d.rank = rank / part;
	d.radius = clamp(0.5 * factor * disc_px / sqrt(part), radius_least, DISC_RADIUS_MOST * max(size.z, 1.0));
	if (!(at.z > lens.w && at.z <= cuts.z && rank < part && all(greaterThan(d.at, vec2(-d.radius))) &&
		    all(lessThan(d.at, size.xy + d.radius))))
		return false;
	if (!tilt_disc(p, radius_least, views[n].mask.w > 0.0, d))
		return false;
	/* Flat discs have flat boxes. */
	vec2 half_px = d.radius * sqrt((1.0 + d.squash.yx * d.squash.yx) / (1.0 + dot(d.squash, d.squash))) + DISC_ROUNDING;
	d.box.xy = max(ivec2(floor(d.at - half_px)), ivec2(0));
	d.box.zw = min(ivec2(floor(d.at + half_px)), ivec2(size.xy) - 1);
	return true;
}

/* Squared distance from the disc's middle, as it would be met straight; from is the middle to the place. */
float disc_away2(disc d, vec2 from)
{
	float across = dot(d.squash, from);
	return dot(from, from) + across * across;
}
