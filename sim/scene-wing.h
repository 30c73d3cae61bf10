#ifndef SIM_SCENE_WING_H
#define SIM_SCENE_WING_H
/* Whole wings of buildings, in the frame of a facade (see scene-facade.h), `length` metres along x.
 */
#include "sim/scene-palette.h"

/* Three to four storeys of ashlar and plaster, a projecting middle with a pediment, stairs to its
 * door. Its floor is 0.9 m above the ground. */
void wing_grand(struct site *s, const struct pen *p, const struct palette *m, float length);
void wing_brick(struct site *s, const struct pen *p, const struct palette *m, float length);
/* Round arches on columns with vaults behind them. */
void wing_arcade(struct site *s, const struct pen *p, const struct palette *m, float length);
/* Two storeys with a gate, ivy on the wall. */
void wing_gate(struct site *s, const struct pen *p, const struct palette *m, float length);
/* A house of a street in a style of its own, perhaps with a shop; open_left, open_right: that end
 * is seen and has windows too. */
void wing_house(struct site *s, const struct pen *p, const struct palette *m, float length,
	bool open_left, bool open_right);
void draw_tower(struct site *s, const struct pen *p, const struct palette *m);
/* Leaves on a wall from x0 to x1, up to a ragged height. */
void draw_ivy(struct site *s, const struct pen *p, uint16_t leaf, float x0, float x1, float height);

#endif
