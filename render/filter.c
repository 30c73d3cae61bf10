#include "render/filter-planes.h"
#include "render/large.h"
#include <math.h>
#include <string.h>

/* ---- memory ---- */

void *filter_room_part(filter_room *r, uint32_t part, size_t bytes)
{
	g_assert(part < FILTER_ROOM_PARTS);
	if (r->bytes[part] < bytes) {
		large_free(r->memory[part]);
		r->bytes[part] = bytes + bytes / 8;
		r->memory[part] = large_new(r->bytes[part]);
	}
	return r->memory[part];
}

void filter_room_clear(filter_room *r)
{
	for (uint32_t n = 0; n < FILTER_ROOM_PARTS; n++)
		large_free(r->memory[n]);
	*r = (filter_room){ 0 };
}

/* ---- the table ---- */

static bool always(const struct step *s)
{
	(void)s;
	return true;
}

static bool grade_has_segments(const struct step *s)
{
	return s->grade.segments > 0;
}

static const struct row {
	const char *name; /* of the kind */
	filter_run *run;
	bool (*wants_surface)(const struct step *s); /* NULL: never */
} rows[] = {
	{ "kuwahara", filter_kuwahara, NULL },
	{ "anisotropic-kuwahara", filter_anisotropic, NULL },
	{ "bilateral", filter_bilateral, NULL },
	{ "gaussian", filter_gaussian, NULL },
	{ "gaps", filter_gaps, NULL },
	{ "quantise", filter_quantise, NULL },
	{ "dog", filter_dog, NULL },
	{ "edges", filter_edges, always },
	{ "watercolour", filter_watercolour, NULL },
	{ "flow", filter_flow, NULL },
	{ "oil", filter_oil, NULL },
	{ "pencil", filter_pencil, always },
	{ "grade", filter_grade, grade_has_segments },
	{ "warp", filter_warp, NULL },
	{ "occlusion", filter_occlusion, NULL },
	{ "edl", filter_edl, NULL },
	{ "neural", filter_neural, NULL },
};

static const struct row *row_of(const struct step *s)
{
	for (size_t n = 0; n < G_N_ELEMENTS(rows); n++)
		if (strcmp(rows[n].name, s->kind->name) == 0)
			return &rows[n];
	g_assert_not_reached();
}

void filter_apply(struct filter_job *j, const struct step *s)
{
	if (j->image.width && j->image.height && !frame_is_stopped(j->f))
		row_of(s)->run(j, s);
}

bool filter_wants_surface(const struct step *filters, uint32_t count)
{
	for (uint32_t n = 0; n < count; n++) {
		const struct row *r = row_of(&filters[n]);
		if (r->wants_surface && r->wants_surface(&filters[n]))
			return true;
	}
	return false;
}

uint32_t filter_reach(const struct step *filters, uint32_t count, float px)
{
	float reach = 2;
	for (uint32_t n = 0; n < count; n++)
		reach += filters[n].kind->radius_px(filters[n].bytes) * px + 1;
	return (uint32_t)ceilf(fminf(reach, 1e5f));
}

/* ---- for filters ---- */

void filter_each_rows(const struct filter_job *j, filter_rows *run, const void *data,
	uint32_t height, uint32_t at_once)
{
#pragma omp parallel for schedule(dynamic, 1) num_threads((int)frame_threads(j->f))
	for (uint32_t from = 0; from < height; from += at_once)
		if (!frame_is_stopped(j->f))
			run(data, from, MIN(from + at_once, height));
}

void filter_finish_part(struct filter_job *j, int32_t where, float times, float less)
{
	struct filter_mix_job m = { j, where, times, less };
	if (filter_is_weighted(j, where))
		filter_each_rows(j, LANES_OF(j->lanes, filter_mix_rows), &m, j->image.height, 64);
	filter_swap(&j->image);
}

void filter_finish(struct filter_job *j, int32_t where)
{
	filter_finish_part(j, where, 1, 0);
}
