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

const float STEP_LEAST = 0.03, STEP_SURE = 0.08, STEP_SHARE = 0.5, STEP_ASIDE = 0.104, CONTOURS_REACH = 2.0, REACH_LEAST_PX = 2.0;
const int COLUMNS = 32;

/* 0..1: how surely what the mask has there lies behind. */
float is_behind(ivec2 at, float depth_m)
{
	float behind = (mask_depth(texelFetch(mask_keys, at, 0).r) / depth_m - 1.0) * stretch(depth_m);
	return clamp((behind - STEP_LEAST) * (1.0 / (STEP_SURE - STEP_LEAST)), 0.0, 1.0);
}

/* What lies behind of all around: how far aside on average, in reaches, and its share. */
vec3 look_behind(vec2 middle, float reach_px, float depth_m)
{
	int stride = 1 + int(2.0 * reach_px / float(COLUMNS - 2)), half_count = int(reach_px / float(stride));
	ivec2 first = ivec2(floor(middle)) - half_count * stride;
	vec3 sum = vec3(0.0);
	float whole = 0.0;
	for (int row = 0; row < 2 * half_count + 2; row++)
		for (int column = 0; column < 2 * half_count + 2; column++) {
			ivec2 at = first + stride * ivec2(column, row);
			vec2 away = (vec2(at) - middle) / reach_px, left = max(1.0 - away * away, 0.0);
			if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(size.xy))))
				continue;
			float weight = left.x * left.x * left.y * left.y;
			whole += weight;
			if (weight > 0.0)
				sum += weight * is_behind(at, depth_m) * vec3(away, 1.0);
		}
	return sum / max(whole, 1e-3);
}

/* The same where the picture falls off beside a point; raises what there is. */
float step_weight(candidate c, float weight, inout hatch h)
{
	vec3 behind = look_behind(c.at - 0.5, max(CONTOURS_REACH * contour.y, REACH_LEAST_PX), c.depth_m);
	float left = length(behind.xy);
	float falls = contour_least.z * min(behind.z * (1.0 / STEP_SHARE), 1.0) * min(left * (1.0 / STEP_ASIDE), 1.0);
	if (falls <= weight)
		return weight;
	h.way[0] = vec3(vec2(-behind.y, behind.x) / max(left, 1e-6), 0.0);
	return falls;
}
