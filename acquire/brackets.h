#ifndef ACQUIRE_BRACKETS_H
#define ACQUIRE_BRACKETS_H
/* Frames of one photo stop, taken with different exposures, as one photo: NV12 like any other, in which more light and shade still differ.
 *
 * Merging goes by Debevec & Malik (1997, section 2.1), with a curve that is known (sRGB's) and exposures that are known: each frame says of each
 * colour of a pixel how much light there was, weighed by how far it is from black and white, and by the light that it gathered, of which longer
 * exposures have less noise. What is white in the longer ones comes from the shorter.
 *
 * One tone curve takes it back to eight bits, the same for all photos of a scan and for all scans, so that neighbours agree: light up to the
 * knee stays as it is in the base exposure; above, the shoulder of Reinhard et al. (2002, equation 4) goes smoothly to white, which is four times
 * (2 EV) the light that is white in the base exposure.
 *
 * A pixel's hue is that of its 2 x 2 block, as NV12 has it. All of it is by tables; rows are spread over the cores. */
#include "acquire/colour.h"
#include "acquire/exposures.h"

#define BRACKETS_KNEE  0.5 /* of the base's white, linear */
#define BRACKETS_WHITE 4.0

/* Light, 1 being white in the base exposure, to 0..1 linear. */
double brackets_tone(double light);

/* NV12 and how much light it gathered (exposures_light), in any unit. */
struct bracket_frame {
	const uint8_t *pixels;
	double light;
};
/* 1 to EXPOSURES_MAX frames of one size, both sides even; base_light: of an exposure in which white is to be 1. ret_pixels: of the same size. */
void brackets_merge(const struct bracket_frame *frames, uint32_t count, double base_light,
	uint32_t width, uint32_t height, uint8_t *ret_pixels);

/* Makes photos of the frames of one stop after the other. One owner. The frames of one stop at most are kept, and the photos. */
typedef struct brackets brackets;
brackets *brackets_new(void);
void brackets_free(brackets *b); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(brackets, brackets_free)

/* A stop with these exposures begins; the one before is over, and gives its photo of the frames that came. A stop with one exposure gives its
 * frame as it is. Of two stops at the same angle (the first was cut off) the one with more frames counts. count 0: none begins. */
void brackets_stop(brackets *b, const struct exposures *e);
/* A frame: kept if it is the first of one of the stop's exposures, and of the size of the others. */
void brackets_add(
	brackets *b, const struct camera_frame_info *info, const uint8_t *pixels, double front_rad);
/* Photos of all stops, appended to an array of struct photo: the pixels are the caller's to free. How many of them were made of several exposures. */
uint32_t brackets_take(brackets *b, GArray *photos);

#endif
