#ifndef RENDER_GLES_DRAW_PRIVATE_H
#define RENDER_GLES_DRAW_PRIVATE_H
/* The stages of gles_draw_frame, in their order. Each leaves barriers behind for what comes next. */
#include "render/gles-buffer.h"
#include "render/gles-draw.h"
#include "render/gles-layers.h"
#include "render/gles-planes.h"
#include "render/gles-programs.h"
#include "render/gles-scene.h"
#include "render/gles-stipple.h"
#include "render/gles-targets.h"
#include "render/gles-views.h"

/* Words of a stroke in its buffer (choose-write.glsl). */
#define GLES_STROKE_WORDS 10
/* Groups of one dispatch. */
#define GLES_GROUPS_MAX 65535u

/* Commands of choose-scan.glsl. */
struct gles_commands {
	uint32_t command[FRAME_LAYERS_MAX][4], total[FRAME_LAYERS_MAX];
};
_Static_assert(FRAME_LAYERS_MAX == 64, "as choose-scan.glsl has it");

#define GLES_FILTER_PLANES 10
/* What filters keep from frame to frame (gles-filter.h). */
struct gles_filters {
	struct gles_buffer rules; /* of the last pass */
	struct gles_buffer plane[GLES_FILTER_PLANES];
	struct gles_buffer taps; /* of the anisotropic filter, for that radius */
	float taps_radius;
};

/* What frames with filters keep (gles-sheets.c): buffers alone. */
struct gles_sheets {
	struct gles_buffer pixels, spare, depth, surface, away, grey; /* of a sheet */
	struct gles_buffer sums, nearest, leaves;                     /* of its surface */
	struct gles_buffer whole, whole_depth, whole_surface, soft, joined, pushed;
};

struct gles_draw {
	const gles_context *c;
	GLuint program[GLES_USES];
	gles_scene scene;
	gles_layers layers;
	gles_views views;
	gles_targets targets;
	struct gles_buffer keys, deepest, sums, marks, asked, commands, strokes[FRAME_LAYERS_MAX];
	struct gles_buffer links,
		shown; /* of profile lines: struct profile_link, and how far each is to be seen */
	struct gles_buffer camera;
	GLuint vertices, srgb;
	bool sums_ink; /* gles-ink.h */
	struct gles_buffer ink;
	struct gles_planes planes;
	struct gles_stipple stipple;
	struct gles_filters filters;
	struct gles_sheets sheets;
};

static inline const struct gles_run *gles_draw_run(const gles_draw *d, guint n)
{
	return &g_array_index(d->views.runs, struct gles_run, n);
}
/* All words of a buffer. */
void gles_draw_fill(gles_draw *d, const struct gles_buffer *b, uint32_t words, uint32_t value);
void gles_draw_bind_storage(const gles_draw *d, GLuint binding, GLuint name);
void gles_draw_bind_texture(const gles_draw *d, GLuint unit, GLenum target, GLuint name);

/* All that is made when it is first wanted, for it takes the places of what shaders read. */
bool gles_draw_hold(gles_draw *d, const frame *f, GError **error);
/* All points of a run, by the program that is used; its views are bound. */
void gles_draw_points_of(gles_draw *d, const struct gles_run *r);
bool gles_draw_mask(gles_draw *d, const frame *f, GError **error);
/* Of views that the mask hides nothing is drawn any more. */
bool gles_draw_hide(gles_draw *d, GError **error);
/* From the storage that is bound into the texture that all that comes later looks the mask up in. */
void gles_draw_keys(gles_draw *d, enum gles_use use);
/* layers: a bit for each one that is drawn, here and below. */
bool gles_draw_choose(gles_draw *d, const frame *f, uint64_t layers, GError **error);
/* Which points of a layer of stippling are drawn (stipple.h); then what GLES_STIPPLE_COUNT and _WRITE read of it is bound. */
bool gles_draw_stipple(gles_draw *d, const frame *f, uint32_t layer, GError **error);
/* The strokes of a layer of profile lines, and the command that draws them. */
bool gles_draw_profile(gles_draw *d, const frame *f, uint32_t layer, GError **error);
/* Draws the canvas's paper, points and shading; ink over it; and the picture of it. */
bool gles_draw_ground(gles_draw *d, bool is_flat, GError **error);
bool gles_draw_ink(gles_draw *d, const frame *f, uint64_t layers, GError **error);
void gles_draw_out(gles_draw *d);
/* By the program that is used, which knows the ink: onto the canvas, which is bound. */
void gles_draw_combine(gles_draw *d, enum band_blend blend);
/* How many strokes there were; false: a layer had more than its buffer holds, which is larger now. */
bool gles_draw_strokes(
	gles_draw *d, uint32_t layers, uint32_t *ret_count, bool *ret_whole, GError **error);

/* All stages, for some of what a frame has. */
struct gles_part {
	const struct chunk_view *view; /* from near to far */
	uint32_t count;
	uint64_t layers;
	bool is_flat; /* on paper without grain, and nothing fades */
	bool is_over; /* on what sheets became, whose mask is there */
};
bool gles_draw_part(gles_draw *d, const frame *f, const struct gles_part *p, struct draw_times *t,
	bool is_timed, GError **error);
/* Seconds since the last one; what was asked for is done then. 0 where nothing is timed. */
double gles_draw_lap(const gles_draw *d, bool is_timed, int64_t *since_us);

/* A frame with filters, into to; or, ret_is_drawn, into the target of the picture. */
bool gles_sheets_draw(gles_draw *d, const frame *f, struct picture_buffer *to, struct draw_times *t,
	bool is_timed, bool *ret_is_drawn, GError **error);
bool gles_sheets_ground(gles_draw *d, GError **error);
void gles_sheets_clear(const gles_context *c, struct gles_sheets *s);

#endif
