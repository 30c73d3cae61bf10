#include "render/edl.h"

/* Nothing is far away, where the optical axis ends. */
static float depth_log2(const frame *f, const visibility_mask *m, int x, int y)
{
	x = CLAMP(x, 0, (int)m->width - 1);
	y = CLAMP(y, 0, (int)m->height - 1);
	float depth_m = mask_depth(mask_key(m, x, y));
	return log2f(fminf(depth_m, (float)f->camera.far_m));
}

static float shade(const frame *f, const visibility_mask *m, const struct edl_step *s,
	const int ring[EDL_AROUND][2], int x, int y)
{
	float here = depth_log2(f, m, x, y), than[EDL_AROUND];
	float apart =
		frame_apart_px(f, mask_depth(mask_key(m, x, y))) / edl_radius(s->radius_px * f->px);
	for (int n = 0; n < EDL_AROUND; n++)
		than[n] = here - depth_log2(f, m, x + ring[n][0], y + ring[n][1]);
	return edl_light(s->strength, edl_deeper(than, apart));
}

void edl_shade(
	const struct band *b, const frame *f, const visibility_mask *m, float *const canvas[3])
{
	const struct edl_step *steps[256] = { NULL };
	int ring[256][EDL_AROUND][2];
	bool any = false;
	for (guint p = 0; p < f->drawing->pipelines->len; p++) {
		const struct step *step = frame_step(f, p, "edl");
		steps[p] = step ? &step->edl : NULL;
		if (step)
			edl_ring(step->edl.radius_px * f->px, ring[p]);
		any |= step != NULL;
	}
	for (uint32_t y = b->from; any && y < b->from + b->rows; y++)
		for (uint32_t x = 0; x < b->width; x++) {
			int32_t key = mask_key(m, (int32_t)x, (int32_t)y);
			if (key >= MASK_EMPTY || !steps[key & 255])
				continue;
			float by = shade(f, m, steps[key & 255], (const int(*)[2])ring[key & 255],
				(int)x, (int)y);
			for (int k = 0; k < 3; k++)
				band_row(b, canvas[k], y)[x] *= by;
		}
}
