/* Strokes lie where planes cut through the site, evenly apart: so they run along walls and grounds as these are seen, and stay on them when
 * the camera moves. How far apart planes are goes by octaves, of which every second plane fades, so that strokes are as dense on the
 * screen from any distance and at any slant. */
#include "render/filter-tables.h"
#include "render/grain.h"
#include <math.h>
#include <string.h>

struct sketch {
	const struct filter_job *j;
	const struct pencil_step *step;
	const float *lightness, *press, *sway_m; /* press: noise; sway_m: waves */
	int layers;
	struct pencil_layer layer[PENCIL_LAYERS_MOST];
};

/* What is seen at a pixel. */
struct sketched {
	float ray[3]; /* of depth 1 */
	float way[3]; /* from the eye to it, of depth 1 */
	float normal[3];
	float depth_m;
};

static struct sketched sketched_at(const struct filter_job *j, uint32_t x, uint32_t y)
{
	const struct camera *c = &j->f->camera;
	const struct filter_image *i = &j->image;
	size_t at = (size_t)y * i->width + x;
	struct lens l = lens_of(c);
	float by_focal = 1 / l.focal_px;
	struct sketched s = { .ray = { 0, 0, 1 }, .way = { 0, 0, 1 }, .depth_m = i->depth_m[at] };
	float seen[2] = { ((float)(x + i->left) + 0.5f - l.middle_x) * by_focal,
		((float)(y + i->top) + 0.5f - l.middle_y) * by_focal };
	for (int k = 0; k < 2; k++) {
		s.ray[k] = seen[k] * l.fan;
		s.way[k] = seen[k] * (LENS_SCALE_M(&l, s.depth_m) / s.depth_m);
	}
	memcpy(s.normal, i->normal[at], sizeof s.normal);
	/* Leaves face the eye; what is met at a low angle counts as met at a less low one. */
	float along = 0, length = 0;
	for (int k = 0; k < 3; k++) {
		along += s.normal[k] * s.ray[k];
		length += s.ray[k] * s.ray[k];
	}
	length = sqrtf(length);
	if (along > -0.08f * length)
		for (int k = 0; k < 3; k++)
			s.normal[k] = -s.ray[k] / length;
	return s;
}

static float dot(const float a[3], const float b[3])
{
	return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* How many metres of a direction there are in a pixel of the surface, across its planes. */
static float metres_a_pixel(
	const struct filter_job *j, const struct sketched *s, const float across[3])
{
	float towards = dot(across, s->ray) / dot(s->normal, s->ray);
	float right = across[0] - towards * s->normal[0], down = across[1] - towards * s->normal[1];
	return camera_scale_f(&j->f->camera, s->depth_m) / (float)j->f->camera.focal_px *
	       sqrtf(right * right + down * down);
}

/* How steep the shortest waves of an unsteady hand are, a pixel of wobble. */
#define SWAY 0.0009f

/* A plane's own, whichever octave it is asked in: where it is in the coarsest that has it. */
static float plane_press(int layer, int octave, int32_t number)
{
	int finer = number ? __builtin_ctz((uint32_t)number) : 0;
	return grain_unit((uint32_t)(number >> finer),
		       (uint32_t)(octave + finer) * PENCIL_LAYERS_MOST + (uint32_t)layer, 3) -
	       0.5f;
}

/* What of the light a layer lets through. */
static float light_through(
	const struct sketch *s, int layer, const struct sketched *at, size_t pixel, float dark)
{
	const struct pencil_step *k = s->step;
	const struct pencil_layer *l = &s->layer[layer];
	float px = s->j->px, spacing = k->spacing_px * px;
	float pixel_m = fmaxf(metres_a_pixel(s->j, at, l->across), 1e-7f);
	float octave = log2f(spacing * pixel_m) + 1;
	octave = CLAMP(octave, FILTER_NOISE_LOWEST, FILTER_NOISE_LOWEST + FILTER_NOISE_OCTAVES - 1);
	float whole = floorf(octave), part = octave - whole;
	int n = (int)whole - FILTER_NOISE_LOWEST;
	float cell_m = ldexpf(0.5f, (int)whole);
	/* In planes from the eye's. */
	float sway_m = SWAY * fminf(k->wobble_px, k->spacing_px) * s->sway_m[pixel],
	      place = l->eye[n] + (at->depth_m * dot(l->across, at->way) + sway_m) / cell_m;
	float number = rintf(place), away_px = fabsf(place - number) * cell_m / pixel_m;
	/* Every second one fades while the next octave comes. */
	int32_t which = (int32_t)number + l->eye_whole[n];
	float there = which & 1 ? 1 - part : 1;
	float press = 0.8f + 0.4f * s->press[pixel] + 0.6f * plane_press(layer, n, which);
	press = CLAMP(press, 0, 1);
	float half = k->width_px * px / 2 * (0.5f + 0.5f * dark) * (0.5f + 0.5f * press);
	float line = grain_step(half + 0.7f, half - 0.5f, away_px) * press * there;
	return 1 - k->pressure * fminf(dark * 1.6f, 1) * line;
}

/* Light tones stay bare; each layer begins where the one before is strong. */
#define NEXT_LAYER 0.85f
#define BARE       0.06f

static float sketch_light(const struct sketch *s, uint32_t x, uint32_t y)
{
	const struct filter_image *i = &s->j->image;
	size_t at = (size_t)y * i->width + x;
	float light = 1, dark = 1 - s->lightness[at];
	dark = dark * (0.5f + 0.6f * dark) * (float)s->layers * 1.2f;
	if (i->depth_m[at] >= FILTER_FAR || dark <= BARE)
		return 1;
	struct sketched seen = sketched_at(s->j, x, y);
	for (int n = 0; n < s->layers && dark > (float)n * NEXT_LAYER + BARE; n++)
		light *= light_through(
			s, n, &seen, at, fminf(dark - (float)n * NEXT_LAYER - BARE, 1));
	return light;
}

static void sketch_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct sketch *s = data;
	const struct filter_image *i = &s->j->image;
	const struct pencil_step *k = s->step;
	for (uint32_t y = from; y < end; y++)
		for (uint32_t x = 0; x < i->width; x++) {
			size_t at = (size_t)y * i->width + x;
			float ink = (1 - sketch_light(s, x, y)) *
				    (1 + 0.6f * filter_relief(s->j, x, y));
			float rgb[3];
			ink = CLAMP(ink, 0, 1);
			for (int c = 0; c < 3; c++) {
				float own = (float)i->rgba[at][c] * 0.8f,
				      colour = (float)k->colour[c] +
					       k->own_colour * (own - (float)k->colour[c]);
				rgb[c] = (float)i->paper[c] + ink * (colour - (float)i->paper[c]);
			}
			filter_put(i->spare[at], rgb);
		}
}

/* Across a direction that leans so much, and lies askew to walls that run along the site's axes. */
static void set_layer(const frame *f, struct pencil_layer *l, float degrees, int number)
{
	const struct camera *c = &f->camera;
	double lean = degrees * (G_PI / 180), turn = (35 + 47 * number) * (G_PI / 180);
	double site[3] = { cos(lean) * cos(turn), cos(lean) * sin(turn), sin(lean) }, eye = 0;
	const double *row[3] = { c->right, c->down, c->forward };
	for (int k = 0; k < 3; k++) {
		l->across[k] =
			(float)(row[k][0] * site[0] + row[k][1] * site[1] + row[k][2] * site[2]);
		eye += site[k] * f->eye_m[k];
	}
	for (int n = 0; n < FILTER_NOISE_OCTAVES; n++) {
		double at = ldexp(eye, 1 - (n + FILTER_NOISE_LOWEST)), whole = floor(at);
		l->eye[n] = (float)(at - whole);
		l->eye_whole[n] = (int32_t)(uint32_t)(int64_t)whole;
	}
}

int pencil_layers(
	const struct pencil_step *s, const frame *f, struct pencil_layer ret[PENCIL_LAYERS_MOST])
{
	static const float lean_deg[PENCIL_LAYERS_MOST] = { 0, -75, 40, -35, 65, 15 };
	int layers = (int)CLAMP(rintf(s->layers), 1, PENCIL_LAYERS_MOST);
	for (int n = 0; n < layers; n++)
		set_layer(f, &ret[n], s->angle_deg + lean_deg[n], n);
	return layers;
}

void filter_pencil(struct filter_job *j, const struct step *s)
{
	float *lightness =
		filter_room_part(j->room, 0, filter_pixels(&j->image) * sizeof *lightness);
	struct sketch k = { .j = j, .step = &s->pencil, .lightness = lightness };
	k.layers = pencil_layers(&s->pencil, j->f, k.layer);
	filter_lightness_plane(j, lightness);
	const float *calm_m = filter_calm_depth(j, 3);
	k.press = filter_noise(j, 1, 45 * j->px, 17, calm_m);
	k.sway_m = filter_waves(j, 2, PENCIL_SWAY_PX * j->px, calm_m);
	filter_each_rows(j, sketch_rows, &k, j->image.height, 16);
	filter_swap(&j->image);
}
