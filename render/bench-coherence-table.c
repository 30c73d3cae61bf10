#include "render/bench-coherence-private.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdio.h>

#define KEPT_LEAST    0.99
#define DENSITY_LEAST 0.9
#define DENSITY_MOST  1.1
#define CV_MOST       0.25
#define WARP_MOST     0.0325
#define TONE_MOST     0.04

void coherence_print_heading(const struct bench_coherence_options *o)
{
	printf("coherence, %u x %u from %s, %u pairs of neighbouring frames of each path; * misses "
	       "its bar\n\n",
		o->width, o->height, o->view ? o->view : "walk", o->pairs);
	puts("style                        kept (mean)       step (beyond)   density (layers)      "
	     "       "
	     "limited       cv (all)       warp (pixels)   tone (all)    drift   static");
	puts("                          >= 99 %            <= 0.15       %  0.9 .. 1.1             "
	     "            "
	     "%  <= 0.25          <= 3.25 %       <= 0.04");
}

/* ---- figures and bars ---- */

struct figures {
	uint32_t *bars, *missed;
};

/* A figure that has a bar, nine wide. */
static void judge(const struct figures *f, const char *format, double value, bool good)
{
	if (isnan(value)) {
		printf("      -  ");
		return;
	}
	++*f->bars;
	*f->missed += !good;
	printf(format, value);
	printf(good ? "  " : "* ");
}

/* One beside it, without a bar. */
static void beside(const char *format, double value)
{
	char text[32];
	if (isnan(value))
		text[0] = 0;
	else
		g_snprintf(text, sizeof text, format, value);
	printf("%-9s", text);
}

static void print_density(const struct figures *f, const struct coherence_row *r)
{
	if (isnan(r->density_least)) {
		printf("%-31s", "     -");
		return;
	}
	bool good = r->density_least >= DENSITY_LEAST && r->density_most <= DENSITY_MOST;
	++*f->bars;
	*f->missed += !good;
	printf("%5.2f .. %4.2f%c (%4.2f .. %4.2f)   ", r->density_least, r->density_most,
		good ? ' ' : '*', r->layer_least, r->layer_most);
}

void coherence_print(const struct coherence_row *r, uint32_t *bars, uint32_t *missed)
{
	struct figures f = { bars, missed };
	printf("%-26s", r->style);
	judge(&f, "%7.2f", 100 * r->kept_least, r->kept_least >= KEPT_LEAST);
	beside("(%.2f)", 100 * r->kept);
	judge(&f, "%7.2f", r->step_most, r->step_most <= STEP_MOST);
	beside("(%.3f)", 100 * r->jumped_share);
	print_density(&f, r);
	beside("%5.1f", 100 * r->limited_share);
	judge(&f, "%7.2f", r->cv, r->cv <= CV_MOST);
	beside("(%.2f)", r->cv_all);
	judge(&f, "%7.2f", 100 * r->warp, r->warp <= WARP_MOST);
	beside("(%.2f)", r->warp_pixels);
	judge(&f, "%7.3f", r->tone, r->tone <= TONE_MOST);
	beside("(%.3f)", r->tone_all);
	beside("%.3f", r->tone_drift);
	++*bars;
	*missed += !r->is_static;
	puts(r->is_static ? "same" : "other*");
}

JsonObject *coherence_to_json(const struct coherence_row *r)
{
	JsonObject *o = json_object_new();
	const struct {
		const char *key;
		double value;
	} member[] = { { "kept_least", r->kept_least }, { "kept", r->kept },
		{ "step_most", r->step_most }, { "jumped_share", r->jumped_share },
		{ "density_least", r->density_least }, { "density_most", r->density_most },
		{ "layer_density_least", r->layer_least }, { "layer_density_most", r->layer_most },
		{ "limited_share", r->limited_share }, { "cv", r->cv }, { "cv_all", r->cv_all },
		{ "warp", r->warp }, { "warp_pixels", r->warp_pixels }, { "tone", r->tone },
		{ "tone_all", r->tone_all }, { "tone_bias", r->tone_bias },
		{ "tone_drift", r->tone_drift } };
	json_object_set_string_member(o, "style", r->style);
	json_object_set_string_member(o, "path", r->path);
	for (size_t n = 0; n < G_N_ELEMENTS(member); n++)
		if (isfinite(member[n].value))
			json_object_set_double_member(o, member[n].key, member[n].value);
	json_object_set_boolean_member(o, "static", r->is_static);
	return o;
}
