#ifndef RENDER_STYLE_H
#define RENDER_STYLE_H
/* A style: how a site is drawn, as data (pleinair-style(5)). For nodes of the segment tree (process/segments.h) it has a pipeline
 * of steps (step.h), which is inherited and overridden downwards (Wegen et al. 2024, section 4.2):
 *
 *     { "schema": 1, "title": "Pencil", "source": "pleinair", "description": "...", "base": "other-style",
 *       "paper": { "texture": "cartridge", "colour": "#f7f3e8", "grain": 0.3 },
 *       "light": { "amount": 0.8, "azimuth_deg": 315, "elevation_deg": 40 },
 *       "focus": { "amount": 1, "radius_m": 6, "x_m": 3, "y_m": -2, "z_m": 1 },
 *       "segments": {
 *           "site": { "steps": [ { "step": "strokes", "id": "edges", "points": "directional", "length_px": 30 }, ... ] },
 *           "vegetation": { "remove": [ "tone" ], "change": { "edges": { "opacity": 0.5 } }, "add": [ { "step": "sprites", ... } ] },
 *           "Tree 4": { "steps": [ ... ] },
 *           "#19": { ... } } }
 *
 * A node is named as the site ("site"), a class ("building", ...), a segment's name, or "#" and its number; both of these may be
 * said of one segment, the number is applied last. "picture" is none of them: its steps, filters alone, work on the picture of all. "steps" replaces what is inherited, and stands alone; "remove", "change" and
 * "add" (at the end) alter it, in this order. Steps without "id" have the name of their kind. A mask is always there, with the id
 * "mask": change it, or list one of one's own.
 *
 * "base" takes over another style: its paper, light, focus and source where nothing else is said, and its nodes. A node that has "steps" here
 * replaces that of the base; one that alters is applied after that of the base. A base is looked for beside the file first.
 *
 * A style has the name of its file. "name" is for text from memory; in a file it may be left out, and must be the same.
 *
 * Const after it was made; any number of threads may read. */
#include "process/segments.h"
#include "render/step.h"

#define STYLE_ERROR (style_error_quark())
GQuark style_error_quark(void);
enum style_error {
	STYLE_ERROR_UNKNOWN, /* there is no style of this name */
	STYLE_ERROR_JSON,    /* the text is no JSON (acquire/strict-json.h) */
	STYLE_ERROR_FIELD, /* a field is unknown, missing or cannot be, or something is wrong with the base */
	STYLE_ERROR_MANY, /* too many pipelines */
};

#define STYLE_SCHEMA    1
#define STYLE_BYTES_MAX (1 << 20)

struct style_paper {
	const char *texture; /* of paper-texture.h, or the path of a PNG; interned */
	uint8_t colour[4];   /* sRGB */
	float grain;         /* 0..1: how much its relief shades it */
	float scale;         /* of the texture, 1: as it is, at 1200 px of height */
};
/* A lamp far away (Wagner et al. 2022, section 3.1, "light direction"): what turns away from it is darker. Ink becomes denser there, or is
 * left out where it is light; what has the points' colours takes it on these. */
struct style_light {
	float amount; /* 0..1: how much of the lightness it decides; 0: there is none */
	float azimuth_deg; /* where it comes from: clockwise from the site's y axis, on a map that has x to the right */
	float elevation_deg; /* above the ground */
};
/* A place that is drawn whole, and less and less around it (Redmond & Dingliana 2007, section 4.1), or a thing (section 4.2). */
enum style_focus_on {
	FOCUS_PLACE,   /* of the site */
	FOCUS_PICTURE, /* of the picture */
	FOCUS_SEGMENT, /* all else is far away */
};
struct style_focus {
	float amount;      /* 0..1: how much is lost to the paper far away from it */
	float abstraction; /* so much larger, and fewer, strokes become far away: 1 is twice as large */
	float filters; /* 0..1: how much filters that are for what is away, or near, keep to that */
	int32_t on;    /* enum style_focus_on */
	float radius_m;  /* all this is drawn as ever */
	float falloff_m; /* beyond it, until it is far away */
	float x_m, y_m, z_m;
	float across, down;          /* FOCUS_PICTURE: 0..1 of it */
	float radius_px, falloff_px; /* the same as of metres */
	float segment; /* FOCUS_SEGMENT: a number of the tree, a class or a thing; 0: none */
};
static inline bool style_focus_is_there(const struct style_focus *f)
{
	return f->amount > 0 || f->abstraction > 0 || f->filters > 0;
}

/* What a style says of the whole picture, and not of nodes. */
struct style_whole {
	struct style_paper paper;
	struct style_light light;
	struct style_focus focus;
};
struct style_section {
	const char *name, *help;                 /* name: of the object in the file */
	const struct step_parameter *parameters; /* ends with a row without a name */
	size_t offset;                           /* in struct style_whole */
};
extern const struct style_section style_sections[]; /* ends with a row without a name */

typedef struct style style;
struct style {
	char *name, *title, *source,
		*description; /* none is NULL; source: a paper, "pleinair" or "user" */
	char *path;           /* of its file; NULL for one from memory */
	struct style_whole whole;
	GPtrArray *nodes; /* style-private.h */
};
/* Errors: one sentence, "pencil.json line 12: segments.site.steps[0].length_px: 900 is too much; it goes from 1 to 400 px"; those of
 * the file itself are of G_IO_ERROR. A relative path of a texture or a base is from the folder of the file. Whether textures are there
 * is not asked here. */
style *style_load(const char *path, GError **error);
/* length -1: up to a zero byte. */
style *style_parse(const char *text, gssize length, const char *name_for_errors, GError **error);
/* The same, with bases looked for in the site's styles too. */
style *style_parse_for(
	const char *text, const char *name_for_errors, const char *site_path, GError **error);
void style_free(style *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(style, style_free)

/* By name: in SITE/styles/ (site_path may be NULL), in the folders of PLEINAIR_STYLES, in ~/.local/share/pleinair/styles, and where the
 * shipped ones are, ../share/pleinair/styles from the program. A name with a slash or ".json" at its end is a path. */
style *style_find(const char *name, const char *site_path, GError **error);
/* Names of all, sorted, each once; also of those that cannot be read. Free with g_strfreev. */
char **style_names(const char *site_path);
/* The JSON Schema (draft 2020-12) of style files, made from step_kinds, indented; caller frees. */
char *style_schema(void);

#define PIPELINE_STEPS_MAX 16
/* What is drawn of some leaves: the steps in the order of stages, and inside a stage as the style lists them. */
struct pipeline {
	struct mask_step mask;
	struct step steps[PIPELINE_STEPS_MAX]; /* layers, then filters */
	uint32_t layers, filters;              /* no layer: nothing is drawn of these leaves */
	struct inpaint_step inpaint;           /* of what filters of pictures change */
	bool is_focus;                         /* of the segment that the style's focus is on */
};
#define PIPELINES_MAX 255
/* A style for the leaves of a site. Equal pipelines are one; ids do not count in that. */
typedef struct drawing drawing;
struct drawing {
	struct style_whole whole;
	GArray *pipelines;       /* of struct pipeline; at least one */
	struct pipeline picture; /* filters of the picture of all of them */
	int32_t composite_by;    /* enum composite_by */
	uint8_t *
		pipeline_of; /* [SEGMENTS_MAX + 1]: of each leaf; of what is no leaf as of the site */
};
/* tree NULL: no segments, all is drawn as the site. Names in the style that the tree does not have are no error, for a style is for
 * many sites; ret_unused (may be NULL) lists them, in the style's order, free with g_strfreev. Refused are more than PIPELINES_MAX
 * pipelines, and a change of a step that is not inherited where a thing stands in this tree. Needs neither afterwards. */
drawing *drawing_new(const style *s, const segments *tree, char ***ret_unused, GError **error);
void drawing_free(drawing *d); /* NULL is fine */
/* Whether it changes with time (frame.h, time_s). */
bool drawing_sways(const drawing *d);
/* The steps of one node of the tree as it inherits them, the mask first; of STYLE_PICTURE those of "picture", which has no mask. Of
 * struct step, caller frees. Errors of drawing_new. */
#define STYLE_PICTURE G_MAXUINT32
GArray *style_steps(const style *s, const segments *tree, uint32_t node, GError **error);
G_DEFINE_AUTOPTR_CLEANUP_FUNC(drawing, drawing_free)

#endif
