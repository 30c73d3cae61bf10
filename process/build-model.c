#include "process/build-model.h"
#include "firmware-io/files.h"
#include "process/model-inputs.h"
#include "process/model-look.h"
#include "process/model-merge.h"
#include "process/model-overlaps.h"
#include "process/model.h"
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <string.h>

/* Shares of the whole in time, as measured on sites of ten fine scans. */
#define OVERLAPS_SHARE 0.45
#define PARTS_SHARE    0.35

static bool make_folders(const site *s, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(s), "model", NULL);
	g_autofree char *parts = g_build_filename(folder, "parts", NULL);
	return files_make_folder(folder, error) && files_make_folder(parts, error);
}

/* What the parts are to be like. */
struct wanted {
	unsigned level;
	bool is_doubtful; /* one was found to be damaged */
};

static bool update_parts(const site *s, const model_inputs *inputs, const struct wanted *wanted,
	const struct build_progress *progress, struct build_result *result, GError **error)
{
	for (guint i = 0; i < inputs->scans->len; i++) {
		const struct model_input *input = model_inputs_at(inputs, i);
		g_autofree char *doing = g_strdup_printf("sorting scan %u", input->number);
		bool made;
		if (!build_progress_step(progress, (double)i / inputs->scans->len, doing, error) ||
			!model_part_update(s, input, wanted->level, wanted->is_doubtful,
				build_memory(progress->options), &made, error))
			return false;
		result->scans_rebuilt += made;
	}
	return true;
}

static void free_part(gpointer data)
{
	model_part_free(data);
}

static GPtrArray *open_parts(
	const site *s, const model_inputs *inputs, unsigned level, GError **error)
{
	g_autoptr(GPtrArray) parts = g_ptr_array_new_with_free_func(free_part);
	for (guint i = 0; i < inputs->scans->len; i++) {
		const struct model_input *input = model_inputs_at(inputs, i);
		model_part *p = model_part_open(s, input, level);
		if (!p) {
			g_set_error(error, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED,
				"%s: the part of scan %u is not the one that was just made",
				site_path(s), input->number);
			return NULL;
		}
		g_ptr_array_add(parts, p);
	}
	return g_steal_pointer(&parts);
}

static unsigned level_needed(const GPtrArray *parts)
{
	unsigned level = 0;
	for (guint i = 0; i < parts->len; i++)
		level = MAX(level, ((const model_part *)parts->pdata[i])->level_needed);
	return level;
}

/* Of the model that is there: most often it stays. */
static unsigned level_before(const site *s)
{
	g_autofree char *path = model_path(site_path(s));
	g_autoptr(product) p = product_open(path, MODEL_KIND, MODEL_VERSION, NULL);
	double cell_m =
		p ? json_object_get_double_member_with_default(product_manifest(p), "lattice_m", 0)
		  : 0;
	unsigned level = 0;
	while (level < MORTON_LEVEL_MAX && morton_cell_m(level) < cell_m)
		level++;
	return level;
}

/* On the finest lattice that holds them all, which is known when they were made on one. Caller frees. */
static GPtrArray *make_parts(const site *s, const model_inputs *inputs, struct wanted *wanted,
	const struct build_progress *progress, struct build_result *result, GError **error)
{
	for (;;) {
		result->scans_rebuilt = 0;
		if (!update_parts(s, inputs, wanted, progress, result, error))
			return NULL;
		g_autoptr(GPtrArray) parts = open_parts(s, inputs, wanted->level, error);
		if (!parts)
			return NULL;
		unsigned level = level_needed(parts);
		if (level == wanted->level)
			return g_steal_pointer(&parts);
		wanted->level = level;
	}
}

/* Files of scans that are in the model no more. */
static bool remove_strangers(const site *s, const model_inputs *inputs, GError **error)
{
	g_autofree char *folder = g_build_filename(site_path(s), "model", "parts", NULL);
	g_autoptr(GPtrArray) names = files_names(folder, error);
	for (guint i = 0; names && i < names->len; i++) {
		g_autofree char *path = g_build_filename(folder, names->pdata[i], NULL);
		bool is_ours = false;
		for (guint k = 0; k < inputs->scans->len; k++)
			is_ours |= g_ascii_strtoull(names->pdata[i], NULL, 10) ==
				   model_inputs_at(inputs, k)->number;
		if (!is_ours && g_unlink(path))
			return files_fail(error, path, "remove");
	}
	return names;
}

static bool merge_parts(const site *s, const model_inputs *inputs, const GPtrArray *parts,
	unsigned level, const struct build_progress *progress, struct build_result *result,
	GError **error)
{
	g_autofree char *path = model_path(site_path(s));
	model_part *const *part = (model_part *const *)parts->pdata;
	g_autoptr(model_stale) stale = NULL;
	if (!model_stale_find(path, inputs, part, level, &stale, error))
		return false;
	JsonObject *made = json_object_new();
	json_object_set_int_member(made, "method", MODEL_METHOD);
	json_object_set_double_member(made, "lattice_m", morton_cell_m(level));
	json_object_set_double_member(made, "dither_per_m2", inputs->dither_per_m2);
	json_object_set_double_member(made, "tone_exponent", inputs->tone_exponent);
	json_object_set_member(made, "made_from", model_inputs_to_json(inputs));
	return model_merge(path, part, parts->len, level, stale, made, progress, result, error);
}

/* Parts are read where the model changes, and checked there. When one turns out to be damaged, all are checked and those made
 * anew; then nothing of them is in doubt. */
static bool build(const site *s, const model_inputs *inputs, const struct build_options *options,
	struct build_result *result, GError **error)
{
	struct build_progress overlaps = { options, 0, OVERLAPS_SHARE };
	struct build_progress sorting = { options, OVERLAPS_SHARE, OVERLAPS_SHARE + PARTS_SHARE };
	struct build_progress merging = { options, sorting.to, 1 };
	struct wanted wanted = { .level = level_before(s) };
	if (!make_folders(s, error) || !model_overlaps_update(s, inputs, &overlaps, error))
		return false;
	for (;; wanted.is_doubtful = true) {
		g_autoptr(GError) damage = NULL;
		g_autoptr(GPtrArray) parts =
			make_parts(s, inputs, &wanted, &sorting, result, error);
		if (!parts)
			return false;
		if (merge_parts(s, inputs, parts, wanted.level, &merging, result, &damage))
			return remove_strangers(s, inputs, error);
		if (wanted.is_doubtful ||
			!g_error_matches(damage, PRODUCT_ERROR, PRODUCT_ERROR_DAMAGED)) {
			g_propagate_error(error, g_steal_pointer(&damage));
			return false;
		}
	}
}

bool build_model(site *s, const scan_graph *g, const struct build_options *options,
	struct build_result *ret, GError **error)
{
	static const struct build_options defaults;
	gint64 began_us = g_get_monotonic_time();
	g_autoptr(model_inputs) inputs = model_inputs_new(s, g, error);
	*ret = (struct build_result){ 0 };
	if (!inputs)
		return false;
	ret->scans = inputs->scans->len;
	ret->scans_left_out = inputs->left_out;
	bool ok = build(s, inputs, options ? options : &defaults, ret, error) &&
		  model_look_remove(site_path(s), error);
	ret->seconds = 1e-6 * (double)(g_get_monotonic_time() - began_us);
	return ok;
}

bool build_model_is_due(
	const site *s, const scan_graph *g, bool *ret_due, char **ret_why, GError **error)
{
	g_autoptr(model_inputs) inputs = model_inputs_new(s, g, error);
	g_autoptr(GError) damage = NULL;
	if (!inputs)
		return false;
	g_autoptr(model) m = model_open(site_path(s), &damage);
	char *why = NULL;
	if (m && !model_in_short(m).tones)
		why = g_strdup("the model does not tell its points in short yet");
	else if (m)
		why = model_inputs_difference(inputs,
			json_object_get_member(product_manifest(model_file(m)), "made_from"));
	else if (g_error_matches(damage, G_IO_ERROR, G_IO_ERROR_NOT_FOUND))
		why = inputs->scans->len ? g_strdup("there is no model yet") : NULL;
	else if (g_error_matches(damage, PRODUCT_ERROR, PRODUCT_ERROR_VERSION))
		why = g_strdup("the model was written by another version of this program");
	else
		why = g_strdup("the model cannot be read");
	*ret_due = why;
	*ret_why = why;
	return true;
}
