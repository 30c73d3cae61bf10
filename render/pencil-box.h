#ifndef RENDER_PENCIL_BOX_H
#define RENDER_PENCIL_BOX_H
/* A box of coloured pencils (Wagner et al. 2022, section 3.3). Any colour is drawn with the two pencils whose hues are next to its own, one
 * of them by chance, so that many strokes have its hue; each is then mixed with black and white until it is as light and as full as the
 * colour. Plain structs; any thread may read. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

#define PENCIL_BOX_MOST 48u

/* Hue 0..6 (red 0, green 2, blue 4), saturation and value 0..1; of sRGB values 0..1. Of greys the hue is 0. */
struct hsv {
	float hue, saturation, value;
};
struct hsv hsv_of(const float rgb[3]);
void hsv_to_rgb(const struct hsv *c, float ret[3]);

struct pencil {
	float rgb[3]; /* sRGB, 0..1, with as much value as saturation and hue allow: 1 */
	float hue;
};
typedef struct pencil_box pencil_box;
struct pencil_box {
	uint32_t count;                        /* 0: there is none, and colours stay as they are */
	struct pencil pencil[PENCIL_BOX_MOST]; /* by hue */
};
/* json: a list of "#rrggbb" that was checked when it was read. Greys have no hue, and are left out. */
pencil_box pencil_box_of(const char *json);
/* rgb, which is 0..1, becomes what one stroke has; chance 0..1 tells by which pencil. Hues are turned first. */
void pencil_box_draw(const pencil_box *b, float hue_shift_deg, float chance, float rgb[3]);

#endif
