#include "render/gles-programs.h"
#include "render/gles-program.h"
#include "render/gles-shaders.h"
#include "render/step.h"
#include <string.h>

/* What a program is put together of. A part that begins with a dot is the shader of the step of that name. */
static const struct row {
	const char *name;
	const char *common[14];
	const char *vertex, *fragment, *compute;
	const char
		*before[2]; /* of the fragment shader alone: vertex shaders may have no storage */
} rows[GLES_USES] = {
	[GLES_CLEAR] = { "clear", { NULL }, .compute = "clear" },
	[GLES_MASK] = { "mask", { "common", "chunks", "discs" }, .compute = ".mask" },
	[GLES_HOLES] = { "holes", { "common" }, .compute = "holes" },
	[GLES_DEEPEST] = { "deepest", { "common" }, .compute = "deepest" },
	[GLES_HIDE] = { "hide", { "common", "chunks" }, .compute = "hide" },
	[GLES_POINTS] = { "points", { "common", "chunks", "discs" }, .compute = ".points" },
	[GLES_COUNT] = { "choose-count",
		{ "common", "chunks", "marks", "layer", "choose", "hatch", "contour", "cut",
			"paint", "givers" },
		.compute = "choose-count" },
	[GLES_SCAN] = { "choose-scan", { "prefix" }, .compute = "choose-scan" },
	[GLES_WRITE] = { "choose-write",
		{ "common", "chunks", "marks", "layer", "choose", "hatch", "contour", "cut",
			"paint", "givers", "hatch-write", "paint-write", "prefix", "marked" },
		.compute = "choose-write" },
	[GLES_SPRITES] = { "sprites", { "common", "layer", ".sprites", "pen" }, "stroke.vert",
		"stroke.frag" },
	[GLES_LINES] = { "lines", { "common", "layer", ".lines", "pen" }, "stroke.vert",
		"stroke.frag" },
	[GLES_STROKES] = { "strokes", { "common", "layer", ".strokes", "pen" }, "stroke.vert",
		"stroke.frag" },
	[GLES_GROUND] = { "ground", { "common", "relief", "pipelines", "edl-light", ".edl" },
		"picture.vert", "ground.frag" },
	[GLES_COMBINE] = { "combine", { "common", "layer", "relief" }, "picture.vert",
		"combine.frag", .before = { "ink-of-planes" } },
	[GLES_SPRITES_PUT] = { "sprites-put", { "common", "layer", ".sprites", "pen", "ink-sums" },
		.compute = "ink-put" },
	[GLES_LINES_PUT] = { "lines-put", { "common", "layer", ".lines", "pen", "ink-sums" },
		.compute = "ink-put" },
	[GLES_STROKES_PUT] = { "strokes-put", { "common", "layer", ".strokes", "pen", "ink-sums" },
		.compute = "ink-put" },
	[GLES_COMBINE_SUMS] = { "combine-sums", { "common", "layer", "relief" }, "picture.vert",
		"combine.frag", .before = { "ink-sums", "ink-of-sums" } },
	[GLES_OUT] = { "out", { "common" }, "picture.vert", "out.frag" },
	[GLES_STIPPLE_PUT] = { "stipple-put", { "common", "chunks", ".stipple" },
		.compute = "stipple-put" },
	[GLES_STIPPLE_SPREAD] = { "stipple-spread", { NULL }, .compute = "stipple-spread" },
	[GLES_STIPPLE_ASK] = { "stipple-ask", { "common", "chunks", ".stipple" },
		.compute = "stipple-ask" },
	[GLES_STIPPLE_TREE] = { "stipple-tree", { NULL }, .compute = "stipple-tree" },
	[GLES_STIPPLE_DECIDE] = { "stipple-decide", { "common", "chunks", ".stipple" },
		.compute = "stipple-decide" },
	[GLES_STIPPLE_COUNT] = { "stipple-count",
		{ "common", "chunks", "marks", "layer", ".stipple", "stipple-dot" },
		.compute = "choose-count" },
	[GLES_STIPPLE_WRITE] = { "stipple-write",
		{ "common", "chunks", "marks", "layer", ".stipple", "stipple-dot", "prefix",
			"marked" },
		.compute = "stipple-write" },
	[GLES_FILTER_FINISH] = { "filter-finish", { "common", "filter" },
		.compute = "filter-finish" },
	[GLES_FILTER_BLUR] = { "filter-blur", { "common", "filter", "filter-planes" },
		.compute = "filter-blur" },
	[GLES_FILTER_NUMBERS] = { "filter-numbers", { "common", "filter", "filter-planes" },
		.compute = "filter-numbers" },
	[GLES_FILTER_FLOW] = { "filter-flow", { "common", "filter", "filter-planes" },
		.compute = "filter-flow" },
	[GLES_FILTER_TRACE] = { "filter-trace", { "common", "filter", "filter-planes" },
		.compute = "filter-trace" },
	[GLES_FILTER_NOISE] = { "filter-noise", { "common", "filter", "filter-planes" },
		.compute = "filter-noise" },
	[GLES_FILTER_WAVES] = { "filter-waves", { "common", "filter", "filter-planes" },
		.compute = "filter-waves" },
	[GLES_FILTER_GAPS] = { "filter-gaps", { "common", "filter", "filter-planes" },
		.compute = "filter-gaps" },
	[GLES_FILTER_EDGES] = { "filter-edges",
		{ "common", "filter", "filter-planes", "filter-solid" },
		.compute = "filter-edges" },
	[GLES_FILTER_WATERCOLOUR] = { "filter-watercolour",
		{ "common", "filter", "filter-planes", "relief" },
		.compute = "filter-watercolour" },
	[GLES_FILTER_OIL] = { "filter-oil", { "common", "filter", "filter-planes", "relief" },
		.compute = "filter-oil" },
	[GLES_FILTER_PENCIL] = { "filter-pencil",
		{ "common", "filter", "filter-planes", "relief", "filter-hash" },
		.compute = "filter-pencil" },
	[GLES_FILTER_GRADE] = { "filter-grade",
		{ "common", "filter", "filter-planes", "filter-hash" }, .compute = "filter-grade" },
	[GLES_FILTER_WARP] = { "filter-warp", { "common", "filter", "filter-planes" },
		.compute = "filter-warp" },
	[GLES_FILTER_SHADE] = { "filter-shade",
		{ "common", "filter", "filter-planes", "edl-light" }, .compute = "filter-shade" },
	[GLES_FILTER_QUANTISE] = { "filter-quantise",
		{ "common", "filter", "filter-planes", "filter-lab" },
		.compute = "filter-quantise" },
	[GLES_FILTER_BILATERAL] = { "filter-bilateral",
		{ "common", "filter", "filter-planes", "filter-lab" },
		.compute = "filter-bilateral" },
	[GLES_FILTER_DOG] = { "filter-dog", { "common", "filter", "filter-planes", "filter-solid" },
		.compute = "filter-dog" },
	[GLES_FILTER_INPAINT] = { "filter-inpaint", { "common", "filter", "filter-planes" },
		.compute = "filter-inpaint" },
	[GLES_PROFILE_SEE] = { "profile-see", { "common", "profile" }, .compute = "profile-see" },
	[GLES_PROFILE_WRITE] = { "profile-write", { "common", "layer", "profile" },
		.compute = "profile-write" },
	[GLES_PLANE_MASK] = { "plane-mask", { "common", "planes" }, .compute = "plane-mask" },
	[GLES_PLANE_POINTS] = { "plane-points", { "common", "planes" }, .compute = "plane-points" },
	[GLES_PLANE_SURFACE] = { "plane-surface", { "common", "planes", "surface-sums" },
		.compute = "plane-surface" },
	[GLES_SHEET_SURFACE] = { "sheet-surface", { "common", "chunks", "discs", "surface-sums" },
		.compute = "sheet-surface" },
	[GLES_SHEET_TAKE] = { "sheet-take", { "common", "filter" }, .compute = "sheet-take" },
	[GLES_SHEET_MERGE] = { "sheet-merge", { "common", "filter" }, .compute = "sheet-merge" },
	[GLES_SHEET_JOIN] = { "sheet-join", { "common" }, .compute = "sheet-join" },
	[GLES_SHEET_KEYS] = { "sheet-keys", { "common" }, .compute = "sheet-keys" },
	[GLES_SHEET_GROUND] = { "sheet-ground", { "common", "relief", "pipelines" }, "picture.vert",
		"sheet-ground.frag" },
	[GLES_FILTER_KUWAHARA] = { "filter-kuwahara", { "common", "filter" },
		.compute = "filter-kuwahara" },
	[GLES_FILTER_ANISOTROPIC] = { "filter-anisotropic", { "common", "filter" },
		.compute = "filter-anisotropic" },
};

static const char *name_of(const char *part)
{
	return part && *part == '.' ? step_kind_find(part + 1)->glsl : part;
}

static const char *text_of(const char *part)
{
	return part ? gles_shader_find(name_of(part)) : NULL;
}

/* Behind the line of the version. */
static char *fragment_of(const struct row *row)
{
	const char *text = text_of(row->fragment), *rest = text ? strchr(text, '\n') + 1 : NULL;
	GString *all = g_string_new_len(text, rest - text);
	for (size_t n = 0; n < G_N_ELEMENTS(row->before) && row->before[n]; n++)
		g_string_append(all, text_of(row->before[n]));
	g_string_append(all, rest);
	return g_string_free(all, FALSE);
}

static GLuint make(const gles_context *c, const struct row *row, GError **error)
{
	const char *names[G_N_ELEMENTS(row->common) + 1] = { NULL };
	for (size_t n = 0; n < G_N_ELEMENTS(row->common); n++)
		names[n] = name_of(row->common[n]);
	g_autofree char *common = gles_shaders_join(names),
			*fragment = row->fragment ? fragment_of(row) : NULL;
	return gles_program_new(c,
		&(struct gles_program_desc){ .name = row->name,
			.common = *common ? common : NULL,
			.vertex = text_of(row->vertex),
			.fragment = fragment,
			.compute = text_of(row->compute) },
		error);
}

bool gles_programs_make(const gles_context *c, GLuint ret[GLES_USES], GError **error)
{
	memset(ret, 0, GLES_USES * sizeof *ret);
	for (int n = 0; n < GLES_LATER; n++)
		if (!(ret[n] = make(c, &rows[n], error)))
			return false;
	return true;
}

bool gles_programs_want(
	const gles_context *c, GLuint programs[GLES_USES], enum gles_use use, GError **error)
{
	return programs[use] || (programs[use] = make(c, &rows[use], error));
}

void gles_programs_clear(const gles_context *c, GLuint programs[GLES_USES])
{
	for (int n = 0; n < GLES_USES; n++)
		c->gl.DeleteProgram(programs[n]);
}
