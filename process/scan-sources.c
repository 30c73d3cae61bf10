#include "process/scan-sources.h"
#include <math.h>
#include <string.h>

/* Poses that differ by less make the same. */
#define POSE_STEP_M 0.0005
#define POSE_STEP   2e-5

static void source_clear(gpointer data)
{
	struct scan_source *s = data;
	g_free(s->fingerprint);
	g_free(s->key);
}

static const struct placed_scan *placed(const scan_graph *g, uint32_t number)
{
	for (guint i = 0; i < g->scans->len; i++) {
		const struct placed_scan *p = &g_array_index(g->scans, struct placed_scan, i);
		if (p->number == number && p->group)
			return p;
	}
	return NULL;
}

static double apart_m(const struct scan_source *a, const struct scan_source *b)
{
	struct pose between = pose_between(&a->pose, &b->pose);
	return pose_distance_m(&between);
}

/* The nearest scans with a grid in its group. */
static void find_neighbours(GArray *sources, guint of, const struct scan_sources_desc *desc)
{
	struct scan_source *s = scan_sources_at(sources, of);
	for (guint i = 0; i < sources->len; i++) {
		const struct scan_source *other = scan_sources_at(sources, i);
		if (i == of || !s->group || other->group != s->group || other->kind == SCAN_CLOUD ||
			apart_m(s, other) > desc->reach_m)
			continue;
		uint32_t at = s->neighbour_count;
		while (at > 0 && apart_m(s, scan_sources_at(sources, s->neighbours[at - 1])) >
					 apart_m(s, other))
			at--;
		if (at == desc->neighbours)
			continue;
		s->neighbour_count = MIN(s->neighbour_count + 1, desc->neighbours);
		memmove(s->neighbours + at + 1, s->neighbours + at,
			(s->neighbour_count - at - 1) * sizeof *s->neighbours);
		s->neighbours[at] = i;
	}
}

static char *key_of(
	const site *where, GArray *sources, guint of, const struct scan_sources_desc *desc)
{
	const struct scan_source *s = scan_sources_at(sources, of);
	g_autoptr(GString) text = g_string_new(NULL);
	g_autofree char *state = desc->state ? desc->state(where, s->number) : NULL;
	g_string_append_printf(text, "%s %s%s%s", desc->method, s->fingerprint, state ? " " : "",
		state ? state : "");
	for (uint32_t i = 0; i < s->neighbour_count; i++) {
		const struct scan_source *other = scan_sources_at(sources, s->neighbours[i]);
		struct pose p = pose_between(&s->pose, &other->pose);
		g_string_append_printf(text, "\n%s", other->fingerprint);
		for (int a = 0; a < 3; a++)
			for (int b = 0; b < 3; b++)
				g_string_append_printf(
					text, " %ld", lround(p.rotation[a][b] / POSE_STEP));
		for (int a = 0; a < 3; a++)
			g_string_append_printf(
				text, " %ld", lround(p.translation_m[a] / POSE_STEP_M));
	}
	return g_compute_checksum_for_string(G_CHECKSUM_SHA256, text->str, -1);
}

GArray *scan_sources_find(const site *s, const scan_graph *graph,
	const struct scan_sources_desc *desc, GError **error)
{
	g_autoptr(GArray) numbers = site_scans(s, error);
	g_autoptr(GArray) sources = g_array_new(FALSE, TRUE, sizeof(struct scan_source));
	g_array_set_clear_func(sources, source_clear);
	for (guint i = 0; numbers && i < numbers->len; i++) {
		uint32_t number = g_array_index(numbers, uint32_t, i);
		g_autoptr(scan_data) d = scan_data_peek(s, number, error);
		if (!d)
			return NULL;
		const struct placed_scan *p = placed(graph, number);
		struct scan_source source = { .number = number,
			.group = p ? p->group : 0,
			.kind = d->kind,
			.pose = p ? p->pose : POSE_IDENTITY,
			.fingerprint = g_strdup(d->fingerprint) };
		g_array_append_val(sources, source);
	}
	if (!numbers)
		return NULL;
	for (guint i = 0; i < sources->len; i++)
		if (scan_sources_at(sources, i)->kind != SCAN_CLOUD)
			find_neighbours(sources, i, desc);
	for (guint i = 0; i < sources->len; i++)
		scan_sources_at(sources, i)->key = key_of(s, sources, i, desc);
	return g_steal_pointer(&sources);
}

bool scan_sources_is_due(
	const site *s, GArray *sources, scan_source_why why, bool *ret_due, char **ret_why)
{
	g_autoptr(GArray) own = sources;
	*ret_due = false;
	if (ret_why)
		*ret_why = NULL;
	for (guint i = 0; own && !*ret_due && i < own->len; i++) {
		const struct scan_source *source = scan_sources_at(own, i);
		const char *words = why(s, source);
		*ret_due = words;
		if (words && ret_why)
			*ret_why = g_strdup_printf("scan %u %s", source->number, words);
	}
	return own;
}
