#ifndef SIM_SCENE_TREE_H
#define SIM_SCENE_TREE_H
/* Trees, shrubs and other plants, drawn once as models with a trunk, limbs, twigs and some thousand
 * single leaves. */
#include "sim/world-site.h"

enum tree_kind { TREE_ROUND, TREE_SPREADING, TREE_COLUMN, TREE_CONIFER, TREE_WILLOW, TREE_BIRCH };

/* A model, its foot at the origin. Nothing hangs lower than about 2.3 m but the conifer's and
 * willow's skirts. */
uint32_t tree_model(struct site *s, enum tree_kind kind);
/* A round bush of about unit radius that stands on the ground. */
uint32_t shrub_model(struct site *s);
/* A tuft of grass, about a third of a metre high. */
uint32_t tuft_model(struct site *s);
/* Places a model on the ground as a plant of its own. */
void plant(struct site *s, uint32_t model, float x, float y, float scale);

#endif
