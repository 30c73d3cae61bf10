#ifndef RENDER_SCENE_LOAD_H
#define RENDER_SCENE_LOAD_H
/* Reads the points of one node of a scene_tree from the model's file, without the mapping: whatever the disk does is an error of a
 * sentence. Chunks and groups are checked by their checksums; of nodes between them only parts of chunks are read, which nothing
 * can be checked by but that they are numbers. Internal to scene-pager.c. */
#include "render/scene-take.h"
#include "render/scene-tree.h"

struct scene_source {
	const model *model;
	int fd; /* product_reopen() */
	const scene_tree *tree;
	/* Copies: what is mapped of a file may be gone at any time, and who reads it then with it. */
	const struct model_chunk *chunk, *group;
};

/* Of one thread. */
typedef struct scene_loader scene_loader;
scene_loader *scene_loader_new(void);
void scene_loader_free(scene_loader *l); /* NULL is fine */

/* Into the scene, as the chunk, whose place in it is known (first); its id, and bends too. ret_read: bytes. */
bool scene_load(scene_loader *l, const struct scene_source *from, uint32_t node, scene *s,
	struct scene_chunk *c, const struct scene_grey *grey, uint64_t *ret_read, GError **error);

#endif
