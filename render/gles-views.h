#ifndef RENDER_GLES_VIEWS_H
#define RENDER_GLES_VIEWS_H
/* The chunks of a frame that are in view (chunk-view.h), as shaders read them: by pipelines, then by slabs, then from near to far. */
#include "render/frame.h"
#include "render/gles-buffer.h"
#include "render/gles-scene.h"

/* Views of one pipeline in one slab. */
struct gles_run {
	uint32_t slab, first, count;
	uint8_t pipeline;
	bool has_points; /* its pipeline shows coloured points */
};

/* Points that a group of a shader looks at. */
#define GLES_SLICE 256u

/* Of at[3]: points on planes are not drawn as discs. */
#define GLES_VIEW_PLANES 0x80000000u

/* chunk_view of chunks.glsl. */
struct gles_view {
	float base[4], axis[3][4], box[4], mask[4], splat[4], spacing_most_m[4], crown[4];
	uint32_t kind_end[4], at[4], pipeline[4], paint[4];
};

typedef struct gles_views gles_views;
struct gles_views {
	struct gles_buffer buffer;
	GArray *runs;                  /* of struct gles_run */
	const struct chunk_view *view; /* as they were given */
	uint32_t count, points;
	int32_t leaf; /* of all of them; -1: of several */
	/* Of each, in the order of shaders: slices of points that may be discs. */
	GByteArray *slices;
};
/* view: from near to far; kept, not copied. */
bool gles_views_fill(const gles_context *c, gles_views *v, const frame *f, const gles_scene *g,
	const struct chunk_view *view, uint32_t count, GError **error);
void gles_views_clear(const gles_context *c, gles_views *v);

#endif
