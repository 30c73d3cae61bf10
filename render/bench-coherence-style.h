#ifndef RENDER_BENCH_COHERENCE_STYLE_H
#define RENDER_BENCH_COHERENCE_STYLE_H
/* One style on its way along a path: two frames of it, and the sums of what was measured so far. */
#include "render/bench-coherence-private.h"

struct styled {
	char *title;              /* its file's name without .json */
	drawing *drawing, *toned; /* toned NULL: it has no tones */
	drawing *smooth;          /* on paper without grain */
	frame *frame, *toned_frame, *fine_frame;
	bool shares_mask; /* with the baseline */
	/* Of hatching: the scene as light as it takes it for, drawn as plain points that are hidden as its own are; NULL: it has none. */
	scene *bright;
	drawing *bright_drawing;
	frame *bright_frame;
	bool is_static;
	struct shot before, now;
	struct fine_shot fine_before, fine_now;
	/* Of the path so far. */
	struct stroke_tally tally;
	double kept_least, limited, cv, cv_all;
	double density_least, density_most, layer_least, layer_most;
	uint32_t densities, cvs, cvs_all;
	struct tone_sums tone;
	double tone_mean_least, tone_mean_most;
	struct reprojection_sums change, fine_change; /* of luminance */
};

/* baseline NULL: it is one. */
bool styled_open(struct styled *s, const char *name, const bench_place *p, const scene *points,
	const struct camera *c, const struct styled *baseline, GError **error);
void styled_close(struct styled *s); /* what is all 0 is fine */

/* Whether it draws the same bytes again, with another camera in between. */
bool styled_try_static(
	struct styled *s, const struct camera *c, struct picture_buffer *picture, GError **error);

void styled_begin_path(struct styled *s);
/* The style's light comes from elsewhere, so many degrees clockwise of where the style has it. */
void styled_turn_light(struct styled *s, double by_deg);
/* What was now is before. */
void styled_step(struct styled *s);
/* A frame as now; with the mask of the baseline, which must have taken its own, where it does for both. */
bool styled_take(struct styled *s, const struct camera *c, const struct styled *baseline,
	struct picture_buffer *picture, struct picture_buffer *fine, GError **error);
/* Of before and now. r and fine: of the baseline, of its frames and of its fine ones. */
void styled_measure_pair(
	struct styled *s, const reprojection *r, const reprojection *fine, float *const scratch[2]);
/* Of now: density and tone. */
bool styled_measure_frame(
	struct styled *s, const uint8_t *lightness, struct picture_buffer *picture, GError **error);
struct coherence_row styled_row(
	const struct styled *s, const char *path, const struct styled *baseline);

#endif
