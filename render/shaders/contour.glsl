/* Contours: the rules of contour-lanes.c. */
const float CONTOUR_SHORTEST_SEEN = 0.25, BEYOND = 0.08, BENT_SURE = 1.5, GLIDES = 0.06;

float strength(float away_px)
{
	return clamp(1.0 - away_px * (1.0 / contour.y), 0.0, 1.0);
}

float bent_enough(float bent)
{
	float least = max(contour_least.y, 1e-3);
	return clamp((bent - least) * (1.0 / ((BENT_SURE - 1.0) * least)), 0.0, 1.0);
}

/* How near it is to a line of smooth surface; along what that runs is the way of h. */
float smooth_weight(candidate c, vec3 normal, out hatch h)
{
	uint two = contour_least.w > 0.0 ? bends[c.index >> 1] >> ((c.index & 1u) * 16u) : 0u;
	uint bits = looks[c.index].y;
	vec2 k = vec2(bend_of(two & 255u), bend_of(two >> 8 & 255u));
	h.way[0] = h.way[1] = vec3(0.0);
	if ((bits & 0xffffu) == NO_DIRECTION || normal == vec3(0.0) || k.x == 0.0 ||
		points[c.index].z >> 24 >= UNDIRECTED)
		return 0.0;
	vec3 axis = laid_flat(normal, turned(bits)).xyz, across = cross(normal, axis);
	vec3 eye = -normalize(ray_of(c)), way = laid_flat(normal, eye).xyz;
	float cosine = dot(eye, normal), px_per_m = lens.x / scale_m(c.depth_m);
	vec3 turn_of = k.x * dot(axis, way) * axis + k.y * dot(across, way) * across;
	float radial = dot(turn_of, way), most_bent = max(abs(k.x), 1e-3);
	float outline = 0.0, hinted = 0.0;
	outline = contour.z * strength(cosine * cosine * px_per_m / (2.0 * max(radial, 1e-3))) *
		  clamp(1.0 + cosine * (1.0 / BEYOND), 0.0, 1.0) * bent_enough(radial);
	float wider = max(GLIDES * cosine * px_per_m / (most_bent * contour.y), 1.0);
	if (k.x * k.y < 0.0)
		hinted = contour.w * clamp(cosine * (1.0 / BEYOND), 0.0, 1.0) * bent_enough(most_bent) *
			 clamp((contour_least.x - cosine) * (4.0 / max(contour_least.x, 1e-3)), 0.0, 1.0) *
			 strength(abs(radial) / (most_bent * most_bent) * cosine * px_per_m / wider) / wider;
	if (outline >= hinted)
		h.way[0] = laid_flat(normal, cross(normal, turn_of)).xyz;
	else
		h.way[0] = abs(k.y) <= abs(k.x) ? across : axis;
	return max(outline, hinted);
}

const float STEP_LEAST = 0.03, STEP_SURE = 0.08, STEP_PLACES = 4.0, DIAGONAL = 0.7071068;

float is_behind_there(ivec2 at, float depth_m)
{
	at = clamp(at, ivec2(0), ivec2(size.xy) - 1);
	float behind = (mask_depth(texelFetch(mask_keys, at, 0).r) / depth_m - 1.0) * stretch(depth_m);
	return clamp((behind - STEP_LEAST) * (1.0 / (STEP_SURE - STEP_LEAST)), 0.0, 1.0);
}

float is_behind(vec2 at, float depth_m)
{
	vec2 low = floor(at), u = at - low;
	ivec2 p = ivec2(low);
	return (1.0 - u.y) * ((1.0 - u.x) * is_behind_there(p, depth_m) +
				     u.x * is_behind_there(p + ivec2(1, 0), depth_m)) +
	       u.y * ((1.0 - u.x) * is_behind_there(p + ivec2(0, 1), depth_m) +
			     u.x * is_behind_there(p + ivec2(1, 1), depth_m));
}

/* The same where the picture falls off beside a point; raises what there is. */
float step_weight(candidate c, float weight, inout hatch h)
{
	vec2 turn_to[8] = vec2[8](vec2(1.0, 0.0), vec2(DIAGONAL, DIAGONAL), vec2(0.0, 1.0), vec2(-DIAGONAL, DIAGONAL),
		vec2(-1.0, 0.0), vec2(-DIAGONAL, -DIAGONAL), vec2(0.0, -1.0), vec2(DIAGONAL, -DIAGONAL));
	vec3 sum = vec3(0.0);
	for (int n = 0; n < 8; n++)
		sum += is_behind(c.at - 0.5 + contour.y * turn_to[n], c.depth_m) * vec3(turn_to[n], 1.0);
	float left = length(sum.xy);
	float falls = contour_least.z * min(sum.z * (1.0 / STEP_PLACES), 1.0) * min(left, 1.0);
	if (falls <= weight)
		return weight;
	h.way[0] = vec3(vec2(-sum.y, sum.x) / max(left, 1e-3), 0.0);
	return falls;
}
