#ifndef RENDER_BENCH_RENDER_PRIVATE_H
#define RENDER_BENCH_RENDER_PRIVATE_H
/* What pleinair bench render measures, before it is printed. */
#include "render/bench-frames.h"
#include "render/bench-render.h"
#include "render/bench-vtk.h"
#include "render/painter.h"

#define RENDER_CAMERAS 3
#define RENDER_STYLES  4 /* sprites, strokes, paint, points */
extern const char *const render_styles[RENDER_STYLES];

/* Table 1 of the paper. */
struct render_paper {
	const char *name;
	uint64_t points, in_view[RENDER_CAMERAS];
	uint32_t discs_k[RENDER_CAMERAS], strokes_k[RENDER_CAMERAS]; /* thousands */
	double fps[RENDER_CAMERAS];
};
extern const struct render_paper render_papers[2];

/* How a picture of one backend differs from that of cpu. */
struct render_parity {
	double mean;       /* of absolute differences, 0..255 */
	double near_share; /* of pixels with no channel off by more than 8 */
};

struct render_row {
	const struct bench_camera *camera;
	const char *style, *backend;
	struct draw_times times;
	double paper_fps;
	bool has_parity;
	struct render_parity parity;
};

struct render_scene {
	const struct render_paper *paper;
	uint64_t points, points_of_site;
	double new_s, bytes_resident, bytes_of_scene; /* a point */
	double overview_mask_rate;                    /* points in view by the mask's seconds */
	struct bench_camera camera[RENDER_CAMERAS];
	GArray *rows; /* of struct render_row */
	char *gles_why_not;
	struct bench_vtk vtk;
};
/* m: with all points of the scene, mapped. Fills all but paper and points_of_site; clear it in any case. */
bool render_scene_measure(struct render_scene *s, const bench_place *p, const model *m,
	const struct bench_render_options *o, GError **error);
void render_scene_clear(struct render_scene *s);

struct render_strokes {
	uint64_t submitted, drawn;
	double seconds, choose_s, bin_s, draw_s;
};
bool render_strokes_measure(struct render_strokes *ret, const bench_place *p, const scene *s,
	const struct camera *c, uint32_t repeats, GError **error);

/* The fastest of so many, or of those that fit into some seconds. Stages are of frames that wait after each of them, all_s of frames
 * that do not. */
bool render_fastest(painter *p, const frame *f, uint32_t repeats, struct picture_buffer *to,
	struct draw_times *ret, GError **error);
double render_mask_rate(const struct render_scene *s); /* the same of the three cameras */

void render_print_scene(const struct render_scene *s);
void render_print_strokes(const struct render_strokes *s);
JsonObject *render_scene_to_json(const struct render_scene *s);
JsonObject *render_strokes_to_json(const struct render_strokes *s);

#endif
