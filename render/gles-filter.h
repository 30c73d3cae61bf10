#ifndef RENDER_GLES_FILTER_H
#define RENDER_GLES_FILTER_H
/* Filters of pictures on a GPU: what filter.h has on the processor, pass by pass in compute shaders (shaders/filter-*.glsl). A picture and
 * what is known of its pixels lie in storage buffers, row by row without gaps, a word for each pixel's colour and floats for all else; so
 * a filter reads and writes what its C does, and differs by roundings alone. Internal to the gles backend; on the thread of its
 * context. */
#include "render/filter-trace.h"
#include "render/gles-draw-private.h"

/* Of a box of a picture; buffers are the caller's, and change places when a filter swaps what was and what is. */
struct gles_filter_image {
	uint32_t width, height, left, top;
	struct gles_buffer *pixels, *spare; /* rgba */
	struct gles_buffer *depth;
	/* NULL: not there. */
	struct gles_buffer *surface; /* four floats: the normal, the leaf */
	struct gles_buffer *away;
	struct gles_buffer *grey; /* grey_before, 0..255 */
};

struct gles_filter_job {
	gles_draw *d;
	const frame *f;
	struct gles_filter_image image;
	float px, spacing_px;
	double time_s;
	uint8_t paper[4];
	GError *error; /* of the first pass that failed: nothing more is done */
};
/* One filter; compiles what it needs when that is first wanted. Does nothing more when the frame is stopped, or j->error is set. */
void gles_filter_run(struct gles_filter_job *j, const struct step *s);
void gles_filters_clear(const gles_context *c, struct gles_filters *f);

/* For tests: what run does with a picture that is in memory, and its planes that are not NULL; its colours and depths are changed. */
typedef void gles_filter_try(struct gles_filter_job *j, const void *data);
bool gles_filter_picture(gles_draw *d, const struct filter_job *j, gles_filter_try *run,
	const void *data, GError **error);

/* ---- passes ---- */

#define GLES_PASS_BY    112
#define GLES_PASS_WHOLE 88
/* What one pass reads and writes, as its shader says. */
struct gles_pass {
	enum gles_use use;
	int32_t mode;
	uint32_t width, height; /* what is gone through; 0: the picture */
	GLuint from, to;        /* pixels; 0: the picture's, and its spare ones */
	GLuint plane[4];
	GLuint own[8]; /* all buffers, of programs from GLES_SHEET_SURFACE on, instead of these */
	float by[GLES_PASS_BY][4];
	int32_t whole[GLES_PASS_WHOLE][4];
	/* How much it acts by the focus. */
	int32_t where;
	float times, less;
};
void gles_pass_run(struct gles_filter_job *j, const struct gles_pass *p);

/* Memory of any content, so many bytes, or floats a pixel; 0 when there is none, which j->error says. */
GLuint gles_filter_room(struct gles_filter_job *j, uint32_t n, int64_t bytes);
GLuint gles_filter_plane(struct gles_filter_job *j, uint32_t n, uint32_t floats);
void gles_filter_swap(struct gles_filter_image *i);
/* That plane becomes the buffer, and the other way round. */
void gles_filter_take(struct gles_filter_job *j, struct gles_buffer *b, uint32_t plane);
void gles_filter_finish(struct gles_filter_job *j, int32_t where, float times, float less);

/* ---- kinds ---- */

typedef void gles_filter_kind(struct gles_filter_job *j, const struct step *s);
gles_filter_kind gles_kuwahara, gles_anisotropic, gles_bilateral, gles_gaussian, gles_gaps,
	gles_flow;

/* ---- what several filters ask for: the functions of filter-planes.h, filter-solid.h and filter-trace.h ---- */

struct gles_blur {
	GLuint from, to;                  /* 0: the picture's pixels; its spare ones */
	uint32_t width, height, channels; /* 0 0: of the picture */
	uint32_t between; /* the number of a plane for what is blurred across alone */
};
void gles_blur_run(struct gles_filter_job *j, const struct gles_blur *b, float sigma_px);
/* CIELab of the picture's pixels, three floats. */
GLuint gles_to_lab(struct gles_filter_job *j, uint32_t plane);
/* Into plane 2, by planes 0 and 1. */
GLuint gles_flow_find(struct gles_filter_job *j, float sigma_px);
GLuint gles_lightness(struct gles_filter_job *j, uint32_t plane);
/* Parts of blocks of FILTER_SOLID_BLOCK pixels that are something. */
GLuint gles_counts(struct gles_filter_job *j, uint32_t plane);
/* Into that plane, by planes 0 and 1. */
GLuint gles_solidity(struct gles_filter_job *j, uint32_t plane);
/* Into the first plane, by the second. */
GLuint gles_calm_depth(struct gles_filter_job *j, uint32_t plane, uint32_t between);
GLuint gles_noise(
	struct gles_filter_job *j, uint32_t plane, float grain_px, uint32_t seed, GLuint calm);
GLuint gles_waves(struct gles_filter_job *j, uint32_t plane, float shortest_px, GLuint calm);

/* depth-inpaint.h: image.grey becomes what it asks for; then, once filters are through, the depths, in that plane. */
void gles_inpaint_begin(struct gles_filter_job *j);
GLuint gles_inpaint(struct gles_filter_job *j, float threshold, int radius, uint32_t plane);

struct gles_trace {
	GLuint flow;
	GLuint from, to; /* planes, or pixels */
	bool is_pixels, is_across;
	enum filter_trace_by by;
	float sigma;
};
void gles_trace_run(struct gles_filter_job *j, const struct gles_trace *t);

#endif
