#include "render/filter-tables.h"
#include "render/grain.h"
#include <math.h>

struct grading {
	const struct filter_job *j;
	const struct grade_step *step;
	struct grade_tables tables;
};

/* About the grey axis. */
static void turn_of(float degrees, float ret[3][3])
{
	float cosine = cosf(degrees * (float)(G_PI / 180)),
	      sine = sinf(degrees * (float)(G_PI / 180));
	for (int r = 0; r < 3; r++)
		for (int c = 0; c < 3; c++) {
			float around = r == c ? 0 : (c - r + 3) % 3 == 1 ? -1 : 1;
			ret[r][c] = (1 - cosine) / 3 + (r == c ? cosine : 0) +
				    around * sine * 0.57735027f;
		}
}

/* Of about this lightness, whatever it was: darker colours of it, or lighter ones. */
static void tinted(const float tint[3], float lightness, float ret[3])
{
	float own = 0.299f * tint[0] + 0.587f * tint[1] + 0.114f * tint[2];
	for (int k = 0; k < 3; k++)
		ret[k] = lightness < own ? tint[k] * lightness / fmaxf(own, 1e-3f)
					 : tint[k] + (1 - tint[k]) * (lightness - own) /
							     fmaxf(1 - own, 1e-3f);
}

/* A colour for each segment, never grey: neighbouring numbers are far apart. */
static void colour_of_leaf(uint32_t leaf, float ret[3])
{
	float hue = 6 * (float)fmod(leaf * 0.61803398875, 1),
	      strong = 0.45f + 0.25f * grain_unit(leaf, 1, 9);
	for (int k = 0; k < 3; k++) {
		float away = fabsf((float)fmod(hue + 6 - 2 * k, 6) - 3); /* 3 at its own hue.. */
		float full = CLAMP(away - 1, 0, 1);
		ret[k] = 0.62f + strong * (full - 0.55f);
	}
}

static void grade_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct grading *g = data;
	const struct grade_step *s = g->step;
	const struct filter_image *i = &g->j->image;
	float tint[3];
	for (int k = 0; k < 3; k++)
		tint[k] = (float)s->tint[k] / 255;
	for (size_t at = (size_t)from * i->width; at < (size_t)end * i->width; at++) {
		float in[3], c[3], other[3], rgb[3];
		if (filter_is_bare(i, at)) {
			memcpy(i->spare[at], i->rgba[at], 4);
			continue;
		}
		for (int k = 0; k < 3; k++)
			in[k] = g->tables.curve[i->rgba[at][k]];
		for (int k = 0; k < 3; k++)
			c[k] = g->tables.turn[k][0] * in[0] + g->tables.turn[k][1] * in[1] +
			       g->tables.turn[k][2] * in[2];
		float grey = 0.299f * c[0] + 0.587f * c[1] + 0.114f * c[2];
		for (int k = 0; k < 3; k++)
			c[k] = grey + s->saturation * (c[k] - grey);
		c[0] += 0.12f * s->warmth * grey;
		c[2] -= 0.16f * s->warmth * grey;
		if (s->tint_amount > 0) {
			tinted(tint, grey, other);
			for (int k = 0; k < 3; k++)
				c[k] += s->tint_amount * (other[k] - c[k]);
		}
		if (s->segments > 0 && i->leaf && i->leaf[at]) {
			float own[3];
			colour_of_leaf(i->leaf[at], own);
			tinted(own, 0.35f + 0.5f * grey, other);
			for (int k = 0; k < 3; k++)
				c[k] += s->segments * (other[k] - c[k]);
		}
		for (int k = 0; k < 3; k++)
			rgb[k] = 255 * c[k];
		filter_put(i->spare[at], rgb);
	}
}

void grade_tables_make(const struct grade_step *s, struct grade_tables *ret)
{
	turn_of(s->hue_shift_deg, ret->turn);
	for (int n = 0; n < 256; n++) {
		float v = powf((float)n / 255, 1 / s->gamma);
		v = ((v - 0.5f) * s->contrast + 0.5f) * s->brightness;
		ret->curve[n] = CLAMP(v, 0, 1);
	}
}

void filter_grade(struct filter_job *j, const struct step *s)
{
	struct grading g = { .j = j, .step = &s->grade };
	grade_tables_make(g.step, &g.tables);
	filter_each_rows(j, grade_rows, &g, j->image.height, 32);
	filter_finish(j, s->grade.where);
}
