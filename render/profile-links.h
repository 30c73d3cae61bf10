#ifndef RENDER_PROFILE_LINKS_H
#define RENDER_PROFILE_LINKS_H
/* Profile lines as a layer of the step "profile" draws them from a camera: chains of short straight links, as wide and as dark as they are
 * where nothing hides them. What is hidden both backends tell from their own masks, link by link, by the rules below: a link is seen as far
 * as it is in the mask, so that lines end where what hides them begins and nothing else of them changes when that moves; and where most of
 * those around it are, for surface hides lines on it here and there. Where a run of seen ones ends the pen is lifted.
 *
 * Which lines there are, and how strong, hangs at each place on the scale there alone: on how long the line is on the screen, and how
 * much room it has to itself (scene-lines.h). So lines come and go by fading, and far away only those are left that count most. Wobble,
 * pressure and dots are fixed to places on the line, at the octave that suits the scale. */
#include "render/frame.h"

/* Of one chain they follow each other. Twelve words, as profile.glsl has them. */
struct profile_link {
	float x_px, y_px, end[2]; /* its middle, and from there to its end */
	float see_px[2], depth_m; /* the place on the line itself */
	float half_width_px;
	float alpha, hidden_alpha; /* where it is seen, where it is not */
	uint32_t line;             /* of scene_lines */
	uint32_t flags;            /* enum profile_link_flag */
};
_Static_assert(sizeof(struct profile_link) == 48, "as profile.glsl has it");
enum profile_link_flag {
	LINK_FIRST = 1, /* of its chain */
	LINK_LAST = 2,
	LINK_BEGINS = 4, /* the chain begins where the line does: the pen comes down here */
	LINK_ENDS = 8,
};

/* Neighbours on either side that have a say in whether a link is seen that is hidden itself. */
#define PROFILE_AROUND 4
/* Part of them from which on it begins to be seen, and how quickly it then is: as soon as two thirds are, it is. */
#define PROFILE_SEEN_FROM 0.3f
#define PROFILE_SEEN_RISE 3.f
/* Links in which the pen is lifted, at most. */
#define PROFILE_LIFT_MOST 64
/* How far behind the mask a place is still seen: in metres, and as a part of its depth. */
#define PROFILE_BEHIND_M 0.08f
#define PROFILE_BEHIND   0.006f
/* What is left of the width where a line ends. */
#define PROFILE_TIP 0.2f

/* How many links it takes to lift the pen. */
uint32_t profile_lift(const struct frame_layer *l);
/* Of a layer of the step "profile": of struct profile_link, in the order of lines; caller unrefs. The same on any number of threads. */
GArray *profile_links_new(const frame *f, const struct frame_layer *l);

/* What is left of a link's width so many links from where its run ends, the nearer end of the two; lift: profile_lift(). */
static inline float profile_taper(float links, uint32_t lift)
{
	float part = (links + 0.5f) / ((float)lift + 0.5f);
	part = part < 1 ? part : 1;
	return PROFILE_TIP + (1 - PROFILE_TIP) * part * (2 - part);
}

#endif
