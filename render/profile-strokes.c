#include "render/profile-strokes.h"
#include "render/profile-links.h"
#include <math.h>
#include <string.h>

/* ---- what is seen ---- */

/* At whole places, or the nearest that the mask has. */
static float mask_depth_at(const visibility_mask *m, float x, float y)
{
	return mask_depth(mask_key(m, (int32_t)CLAMP(x, 0, (float)m->width - 1),
		(int32_t)CLAMP(y, 0, (float)m->height - 1)));
}

static float shows(const visibility_mask *m, float x, float y, float depth_m, float slack_m)
{
	float behind_m = depth_m - mask_depth_at(m, x, y);
	return CLAMP(1 - behind_m / slack_m, 0, 1);
}

/* Where any pixel beside it shows it, so does a pixel: what is seen aslant differs much in depth from one to the next. */
static float shows_beside(const float shown[4][4], int x, int y)
{
	float ret = 0;
	for (int down = -1; down <= 1; down++)
		for (int right = -1; right <= 1; right++)
			ret = fmaxf(ret, shown[y + down][x + right]);
	return ret;
}

/* In the four pixels around. */
static float shows_around(
	const visibility_mask *m, const struct lens *lens, const struct profile_link *l)
{
	float slack_m = PROFILE_BEHIND_M + PROFILE_BEHIND * LENS_SCALE_M(lens, l->depth_m);
	float x = l->see_px[0] - 0.5f, y = l->see_px[1] - 0.5f, x0 = floorf(x), y0 = floorf(y),
	      u = x - x0, v = y - y0, shown[4][4];
	for (int down = 0; down < 4; down++)
		for (int right = 0; right < 4; right++)
			shown[down][right] = shows(m, x0 + (float)right - 1, y0 + (float)down - 1,
				l->depth_m, slack_m);
	float upper = (1 - u) * shows_beside(shown, 1, 1) + u * shows_beside(shown, 2, 1),
	      lower = (1 - u) * shows_beside(shown, 1, 2) + u * shows_beside(shown, 2, 2);
	return (1 - v) * upper + v * lower;
}

/* Of the chain from first to end: as far as each is seen, or most around it are. */
static void see(const float *raw, uint32_t first, uint32_t end, float *seen)
{
	for (uint32_t n = first; n < end; n++) {
		uint32_t from = n >= first + PROFILE_AROUND ? n - PROFILE_AROUND : first,
			 to = MIN(n + PROFILE_AROUND + 1, end);
		float sum = 0;
		for (uint32_t k = from; k < to; k++)
			sum += raw[k];
		float part = sum / (float)(to - from);
		float around = CLAMP((part - PROFILE_SEEN_FROM) * PROFILE_SEEN_RISE, 0, 1);
		seen[n] = fmaxf(raw[n], around);
	}
}

/* ---- how far the pen is from where a run ends ---- */

static void lift(const struct profile_link *link, const float *seen, uint32_t first, uint32_t end,
	uint32_t most, float *width)
{
	uint32_t away = link[first].flags & LINK_BEGINS ? 0 : most;
	for (uint32_t n = first; n < end; n++) {
		away = seen[n] < 0.5f ? 0 : away;
		width[n] = profile_taper((float)away, most);
		away = MIN(away + 1, most);
	}
	away = link[end - 1].flags & LINK_ENDS ? 0 : most;
	for (uint32_t n = end; n-- > first;) {
		away = seen[n] < 0.5f ? 0 : away;
		width[n] = fminf(width[n], profile_taper((float)away, most));
		away = MIN(away + 1, most);
	}
}

/* ---- strokes ---- */

/* Links lie over each other by a pixel in all: the strongest at each place counts, so that nobody sees where they meet. */
#define LAP_PX 0.5f

static bool stroke_of(const struct frame_layer *l, const struct profile_link *link, float seen,
	float width, struct stroke *ret)
{
	float length_px = hypotf(link->end[0], link->end[1]);
	float alpha = link->alpha * seen + link->hidden_alpha * (1 - seen);
	if (alpha < PROFILE_ALPHA_LEAST)
		return false;
	*ret = (struct stroke){ .x_px = link->x_px,
		.y_px = link->y_px,
		.along = { 1, 0 },
		.half_length_px = length_px + LAP_PX,
		.half_width_px = link->half_width_px * width,
		.alpha = alpha,
		.q = 1 / link->depth_m,
		.point = link->line };
	for (int k = 0; k < 2 && length_px > 0; k++)
		ret->along[k] = link->end[k] / length_px;
	memcpy(ret->rgb, l->ink.ink, 3);
	return true;
}

void profile_strokes(const frame *f, const struct frame_layer *l, const visibility_mask *m,
	struct stroke_chain *to)
{
	g_autoptr(GArray) links = profile_links_new(f, l);
	const struct profile_link *link = (const struct profile_link *)(void *)links->data;
	g_autofree float *raw = g_new(float, links->len + 1), *seen = g_new(float, links->len + 1),
			 *width = g_new(float, links->len + 1);
	struct lens lens = lens_of(&f->camera);
	for (guint n = 0; n < links->len; n++)
		raw[n] = m ? shows_around(m, &lens, &link[n]) : 1;
	for (guint first = 0, end; first < links->len; first = end) {
		for (end = first + 1; end < links->len && !(link[end].flags & LINK_FIRST);)
			end++;
		see(raw, first, end, seen);
		lift(link, seen, first, end, profile_lift(l), width);
	}
	bool follows = false;
	for (guint n = 0; n < links->len; n++) {
		struct stroke s;
		bool is_drawn = stroke_of(l, &link[n], seen[n], width[n], &s);
		s.copy = follows && !(link[n].flags & LINK_FIRST);
		if (is_drawn)
			stroke_chain_add(to, &s);
		follows = is_drawn;
	}
}
