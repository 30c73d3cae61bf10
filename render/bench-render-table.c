#include "render/bench-render-private.h"
#include <json-glib/json-glib.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#define MASK_RATE_WANTED   250e6
#define STROKE_RATE_WANTED 6e6
#define PARITY_MEAN        2
#define PARITY_NEAR        0.999

static char star(bool good)
{
	return good ? ' ' : '*';
}

static double fps_of(const struct render_row *r)
{
	return 1 / r->times.all_s;
}

/* ---- for people ---- */

static void print_row(const struct render_row *r)
{
	const struct draw_times *t = &r->times;
	/* Coloured points are not what the paper draws. */
	bool is_paper = strcmp(r->style, "points") != 0;
	printf("%-14s %-13s %-4s %5.0f %5.0f %5.0f  %5.1f %6.1f %6.1f %6.1f %6.1f  %6.1f %5.1f%c ",
		r->camera->name, r->style, r->backend, (double)r->camera->in_view * 1e-3,
		(double)r->camera->discs * 1e-3, t->strokes * 1e-3, 1e3 * t->cull_s,
		1e3 * t->mask_s, 1e3 * t->choose_s, 1e3 * t->bin_s, 1e3 * t->draw_s, 1e3 * t->all_s,
		fps_of(r), star(!is_paper || fps_of(r) >= r->paper_fps));
	if (is_paper)
		printf("%4.0f", r->paper_fps);
	if (r->has_parity)
		printf("  off cpu's by %.2f of 255 (<= %d)%c, %.2f %% of pixels within 8 (>= "
		       "%.1f)%c",
			r->parity.mean, PARITY_MEAN, star(r->parity.mean <= PARITY_MEAN),
			100 * r->parity.near_share, 100 * PARITY_NEAR,
			star(r->parity.near_share >= PARITY_NEAR));
	puts("");
}

static void print_vtk(const struct bench_vtk *v)
{
	if (v->why_not) {
		printf("VTK was not measured: %s\n", v->why_not);
		return;
	}
	printf("VTK %s (%s), unstyled points: first frame %.2f s, later", v->version, v->renderer,
		v->first_s);
	for (uint32_t n = 0; n < v->cameras; n++)
		printf("%s %.2f", n ? "," : "", 1 / v->frame_s[n]);
	puts(" fps");
}

void render_print_scene(const struct render_scene *s)
{
	const struct render_paper *p = s->paper;
	printf("scene %s: %.3f of the site's %.3f million points (the paper's: %.3f)%s\n", p->name,
		(double)s->points * 1e-6, (double)s->points_of_site * 1e-6,
		(double)p->points * 1e-6,
		s->points_of_site < p->points ? ": the site has fewer" : "");
	printf("the paper's, in thousands: Nc");
	for (int n = 0; n < RENDER_CAMERAS; n++)
		printf(" %.0f", (double)p->in_view[n] * 1e-3);
	printf(", N1 %u %u %u, N2 %u %u %u\n", p->discs_k[0], p->discs_k[1], p->discs_k[2],
		p->strokes_k[0], p->strokes_k[1], p->strokes_k[2]);
	puts("camera         style         by      Nc    N1    N2   cull   mask choose    bin   "
	     "draw   "
	     "all ms   fps  paper");
	for (guint n = 0; n < s->rows->len; n++)
		print_row(&g_array_index(s->rows, struct render_row, n));
	if (s->gles_why_not)
		printf("gles was not measured: %s\n", s->gles_why_not);
	print_vtk(&s->vtk);
	printf("mask: %.0f million points/s of the overview (>= %.0f)%c, %.0f of the cameras "
	       "above; "
	       "scene made in %.2f s; %.1f bytes a point in memory, of these the scene %.1f\n\n",
		s->overview_mask_rate * 1e-6, MASK_RATE_WANTED * 1e-6,
		star(s->overview_mask_rate >= MASK_RATE_WANTED), render_mask_rate(s) * 1e-6,
		s->new_s, s->bytes_resident, s->bytes_of_scene);
	fflush(stdout);
}

void render_print_strokes(const struct render_strokes *s)
{
	double rate = (double)s->submitted / s->seconds;
	printf("textured strokes of 24 x 6 px: %.3f million, %.3f of them drawn, in %.1f ms: %.2f "
	       "million/s submitted (>= %.0f)%c, %.2f drawn; to choose them %.1f ms, to sort them "
	       "into bands %.1f, to draw them %.1f\n",
		(double)s->submitted * 1e-6, (double)s->drawn * 1e-6, 1e3 * s->seconds, rate * 1e-6,
		STROKE_RATE_WANTED * 1e-6, star(rate >= STROKE_RATE_WANTED),
		(double)s->drawn / s->seconds * 1e-6, 1e3 * s->choose_s, 1e3 * s->bin_s,
		1e3 * s->draw_s);
}

/* ---- for programs ---- */

static JsonObject *row_to_json(const struct render_row *r)
{
	JsonObject *o = json_object_new();
	const struct draw_times *t = &r->times;
	const struct {
		const char *key;
		double s;
	} stage[] = { { "cull_s", t->cull_s }, { "mask_s", t->mask_s }, { "choose_s", t->choose_s },
		{ "bin_s", t->bin_s }, { "draw_s", t->draw_s }, { "all_s", t->all_s } };
	json_object_set_string_member(o, "camera", r->camera->name);
	json_object_set_string_member(o, "style", r->style);
	json_object_set_string_member(o, "backend", r->backend);
	json_object_set_int_member(o, "in_view", (gint64)r->camera->in_view);
	json_object_set_int_member(o, "discs", (gint64)r->camera->discs);
	json_object_set_int_member(o, "strokes", t->strokes);
	for (size_t n = 0; n < G_N_ELEMENTS(stage); n++)
		json_object_set_double_member(o, stage[n].key, stage[n].s);
	json_object_set_double_member(o, "fps", fps_of(r));
	json_object_set_double_member(o, "paper_fps", r->paper_fps);
	if (r->has_parity) {
		json_object_set_double_member(o, "parity_mean", r->parity.mean);
		json_object_set_double_member(o, "parity_within_8", r->parity.near_share);
	}
	return o;
}

/* points_s: of the frame with most points in view. */
static JsonObject *vtk_to_json(const struct render_scene *of)
{
	const struct bench_vtk *v = &of->vtk;
	double most = 0, points_s = 0;
	JsonObject *o = json_object_new();
	if (v->why_not) {
		json_object_set_string_member(o, "why_not", v->why_not);
		return o;
	}
	JsonArray *frames = json_array_new(), *fps = json_array_new();
	for (uint32_t n = 0; n < v->cameras; n++) {
		double points = (double)of->camera[n].in_view;
		json_array_add_double_element(frames, v->frame_s[n]);
		json_array_add_double_element(fps, 1 / v->frame_s[n]);
		if (points > most) {
			most = points;
			points_s = points / v->frame_s[n];
		}
	}
	json_object_set_string_member(o, "version", v->version);
	json_object_set_string_member(o, "renderer", v->renderer);
	json_object_set_double_member(o, "first_s", v->first_s);
	json_object_set_array_member(o, "frame_s", frames);
	json_object_set_array_member(o, "fps", fps);
	json_object_set_double_member(o, "points_s", points_s);
	return o;
}

JsonObject *render_scene_to_json(const struct render_scene *s)
{
	JsonObject *o = json_object_new();
	JsonArray *rows = json_array_new();
	for (guint n = 0; n < s->rows->len; n++)
		json_array_add_object_element(
			rows, row_to_json(&g_array_index(s->rows, struct render_row, n)));
	json_object_set_string_member(o, "scene", s->paper->name);
	json_object_set_int_member(o, "points", (gint64)s->points);
	json_object_set_int_member(o, "points_of_site", (gint64)s->points_of_site);
	json_object_set_int_member(o, "points_of_paper", (gint64)s->paper->points);
	json_object_set_array_member(o, "frames", rows);
	if (s->gles_why_not)
		json_object_set_string_member(o, "gles_why_not", s->gles_why_not);
	json_object_set_object_member(o, "vtk", vtk_to_json(s));
	json_object_set_double_member(o, "mask_points_s_of_overview", s->overview_mask_rate);
	json_object_set_double_member(o, "mask_points_s", render_mask_rate(s));
	json_object_set_double_member(o, "scene_new_s", s->new_s);
	if (isfinite(s->bytes_resident))
		json_object_set_double_member(o, "bytes_a_point", s->bytes_resident);
	json_object_set_double_member(o, "bytes_a_point_of_scene", s->bytes_of_scene);
	return o;
}

JsonObject *render_strokes_to_json(const struct render_strokes *s)
{
	JsonObject *o = json_object_new();
	json_object_set_int_member(o, "submitted", (gint64)s->submitted);
	json_object_set_int_member(o, "drawn", (gint64)s->drawn);
	json_object_set_double_member(o, "seconds", s->seconds);
	json_object_set_double_member(o, "submitted_s", (double)s->submitted / s->seconds);
	json_object_set_double_member(o, "choose_s", s->choose_s);
	json_object_set_double_member(o, "bin_s", s->bin_s);
	json_object_set_double_member(o, "draw_s", s->draw_s);
	return o;
}
