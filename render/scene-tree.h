#ifndef RENDER_SCENE_TREE_H
#define RENDER_SCENE_TREE_H
/* What a scene can be drawn from in parts: the chunks of a model, and above them nodes that stand for eight others of their leaf each,
 * with as many points as one chunk has at most: one in eight of their points, the first ones. Three levels above the chunks; the second
 * are the groups that the model has in its file (process/model-coarse.h), the third are tops. Every prefix of a node's points is a uniform
 * subset of what it stands for, as that of a chunk is.
 *
 * Const after it was made. */
#include "process/model.h"

#define SCENE_TREE_LEVELS 4u
#define SCENE_TREE_FAN    8u

struct scene_node {
	double centre_m[3]; /* of its box, which holds those of all below it */
	float half_m[3];
	float part; /* its points, of all that there are below it */
	uint32_t
		child; /* its first one's number; of a chunk that of the chunk in the model, of a group that of the group too */
	uint32_t leaf;
	uint16_t points;
	uint8_t children, level;
};

/* Tops that stand near each other, of any leaf: whether none of them is in view is quickly told. */
#define SCENE_TREE_BUNCH 32u
struct scene_bunch {
	double centre_m[3];
	float half_m[3];
	uint32_t count; /* of the tree's tops, from a multiple of SCENE_TREE_BUNCH on */
};

typedef struct scene_tree scene_tree;
struct scene_tree {
	struct scene_node *node;
	/* Nodes of a level, one after another as in the model. */
	uint32_t first[SCENE_TREE_LEVELS + 1];
	uint32_t *top; /* numbers of all tops, bunch after bunch */
	struct scene_bunch *bunch;
	uint32_t bunches;
};
/* The model must be told in short. G_IO_ERROR_NO_SPACE: it has more chunks than can be counted. */
scene_tree *scene_tree_new(const model *m, GError **error);
void scene_tree_free(scene_tree *t); /* NULL is fine */

static inline uint32_t scene_tree_top(const scene_tree *t)
{
	return t->first[SCENE_TREE_LEVELS - 1];
}
static inline uint32_t scene_tree_end(const scene_tree *t)
{
	return t->first[SCENE_TREE_LEVELS];
}

#endif
