/* What all filters of pictures share (gles-filter.h): a box of a picture, row by row, and numbers of its pixels. Beyond its borders the
 * last pixels go on. Rules and numbers are those of the files of the same names in C. */
layout(local_size_x = 32, local_size_y = 8) in;

layout(std140, binding = 2) uniform Filter {
	ivec4 area;    /* width, height, and where it is in the whole picture */
	ivec4 extent;  /* what is gone through: width, height; which pass it is */
	vec4 bare;     /* the paper, 0..255; a: pixels to one of the style's */
	vec4 acting;   /* by the focus: enum filter_where, 0 where there is none; how much; so often it, less so much */
	vec4 by[112];  /* of the pass */
	ivec4 whole[88];
};
layout(std430, binding = 0) buffer Pixels {
	uint pixels[]; /* rgba */
};
layout(std430, binding = 1) buffer Spare {
	uint spare[];
};
layout(std430, binding = 2) buffer Depths {
	float depths[]; /* FAR where nothing is */
};
layout(std430, binding = 3) buffer Away {
	float away[];
};

const float FAR = 3.0e38;
const uint OPAQUE = 0xff000000u;

/* False: beyond what is gone through. */
bool is_here(out ivec2 p)
{
	p = ivec2(gl_GlobalInvocationID.xy);
	return all(lessThan(p, extent.xy));
}

ivec2 inside(ivec2 p)
{
	return clamp(p, ivec2(0), area.xy - 1);
}

bool is_in_area(ivec2 p)
{
	return all(greaterThanEqual(p, ivec2(0))) && all(lessThan(p, area.xy));
}

int at_of(ivec2 p)
{
	return p.y * area.x + p.x;
}

/* Where what a pixel shows is from the eye, along the site's axes. */
vec3 from_eye_m(ivec2 p, float depth_m)
{
	vec2 way = (vec2(p + area.zw) + 0.5 - lens.yz) / lens.x * (scale_m(depth_m) / depth_m);
	return (turn[0].xyz * way.x + turn[1].xyz * way.y + turn[2].xyz) * depth_m;
}

/* Of the nearest pixel. */
ivec2 nearest(vec2 p)
{
	return ivec2(clamp(p, vec2(0.0), vec2(area.xy - 1)) + 0.5);
}

/* 0..255 */
vec3 rgb_of(uint rgba)
{
	return vec3(uvec3(rgba, rgba >> 8, rgba >> 16) & 255u);
}

uint rgba_of(vec3 rgb)
{
	uvec3 c = uvec3(clamp(rgb, 0.0, 255.0) + 0.5);
	return c.r | c.g << 8 | c.b << 16 | OPAQUE;
}

uint bare_rgba()
{
	return rgba_of(bare.rgb);
}

/* 0..1 of sRGB as the eye weighs it. */
float lightness_of(uint rgba)
{
	uvec3 c = uvec3(rgba, rgba >> 8, rgba >> 16) & 255u;
	return float(77u * c.r + 150u * c.g + 29u * c.b) * (1.0 / (256.0 * 255.0));
}

bool is_bare(int at)
{
	return depths[at] >= FAR && (pixels[at] | OPAQUE) == bare_rgba();
}

float weight_at(int at)
{
	if (acting.x <= 0.0)
		return 1.0;
	float part = acting.x < 1.5 ? away[at] : 1.0 - away[at];
	return 1.0 + acting.y * (part - 1.0);
}

/* grain_step() */
float step_between(float from, float to, float x)
{
	float t = clamp((x - from) / (to - from), 0.0, 1.0);
	return t * t * (3.0 - 2.0 * t);
}

/* Between four pixels, at a place in pixels' middles. */
vec3 colour_between(vec2 p)
{
	p = clamp(p, vec2(0.0), vec2(area.xy - 1));
	ivec2 a = ivec2(p), b = min(a + 1, area.xy - 1);
	vec2 part = p - vec2(a);
	vec3 upper = mix(rgb_of(pixels[at_of(a)]), rgb_of(pixels[at_of(ivec2(b.x, a.y))]), part.x);
	vec3 lower = mix(rgb_of(pixels[at_of(ivec2(a.x, b.y))]), rgb_of(pixels[at_of(b)]), part.x);
	return mix(upper, lower, part.y);
}
