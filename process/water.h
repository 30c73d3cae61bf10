#ifndef PROCESS_WATER_H
#define PROCESS_WATER_H
/* Water, and what crosses it, among the ground (ground.h). Water is level, over a hundred square metres at least, and what lies
 * around it is higher; nobody stands a tripod on it. A deck is ground that ends at a drop into water on both sides of it: of
 * bridges and locks. Water that sends nothing back, as from a tripod most does, has no points, and no class. */
#include "process/ground.h"
#include "process/segment-class.h"

/* enum segment_class of each surfel of the ground: terrain, water or structure; caller frees. */
uint8_t *water_find(const ground *g, const double (*station_m)[3], size_t stations);

#endif
