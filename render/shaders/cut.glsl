/* Lines where the camera's near plane cuts through surfaces: the rules of cut-lanes.c. */
const float CUT_SPACINGS = 3.0, CUT_LEAST_M = 0.01, CUT_MOST_M = 0.1;
const float CUT_SLANT_LEAST = 0.3, CUT_SLANT_SURE = 0.5, CUT_BEFORE = 2.0;

/* Whether it lies in the slab. */
bool is_in_cut(candidate c)
{
	float given_m = cuts.y > 0.0 ? cuts.y : cut.y;
	float thick_m = given_m > 0.0 ? given_m : clamp(c.spacing_m * CUT_SPACINGS, CUT_LEAST_M, CUT_MOST_M);
	return cuts.x > 0.0 && points[c.index].z >> 24 != UNDIRECTED && c.depth_m >= lens.w && c.depth_m <= lens.w + thick_m;
}

/* Moves it onto the cut. */
choice choice_on_cut(vec3 n, inout candidate c)
{
	choice one;
	float sine = length(n.xy), unit = 1.0 / max(sine, 1e-3), px_per_m = lens.x / scale_m(c.depth_m);
	c.at += (c.depth_m - lens.w) * n.z * unit * unit * px_per_m * n.xy;
	one.alpha = clamp((sine - CUT_SLANT_LEAST) * (1.0 / (CUT_SLANT_SURE - CUT_SLANT_LEAST)), 0.0, 1.0) *
		    opacity.x * (1.0 - opacity.y * chance(c, SALT_OPACITY));
	one.growth = one.lit = 1.0;
	one.normal = vec3(0.0);
	one.edge = line(true, vec2(-n.y, n.x) * unit, px_per_m, 0.0);
	return one;
}

float cut_half_px(candidate c, float half_px)
{
	return max(half_px, c.spacing_m * lens.x / scale_m(c.depth_m) * (CUT_SPACINGS / 2.0));
}
