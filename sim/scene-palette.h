#ifndef SIM_SCENE_PALETTE_H
#define SIM_SCENE_PALETTE_H
/* The materials that scenes share, in colours that a seed chooses once. */
#include "sim/world-site.h"

struct palette {
	uint16_t plaster[5], brick[2], ashlar, rustic, rubble;
	uint16_t trim, trim_dark; /* dressed stone: mouldings, sills, columns */
	uint16_t tiles, slate, copper;
	uint16_t frame_light, frame_dark, door[4], plank;
	uint16_t glass, water, inside, inside_floor, curtain;
	uint16_t iron, steel, lamp, brass;
	uint16_t setts, flags, gravel, asphalt, marking, kerb, grass, soil;
	uint16_t wood, terracotta, rubber, shop[3], floor_tiles;
};

void palette_choose(struct site *s, struct palette *ret_palette);
/* One-off plain colours: clothes, car paint, signs. */
uint16_t palette_cloth(struct site *s, vec colour);
uint16_t palette_paint(struct site *s, vec colour);

#endif
