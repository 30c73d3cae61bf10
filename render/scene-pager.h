#ifndef RENDER_SCENE_PAGER_H
#define RENDER_SCENE_PAGER_H
/* Scenes that are larger than the memory they may take (Xu & Chen 2004, section 9: progressive loading of data). Tops of the tree
 * (scene-tree.h) are always there. At each turn, between two frames, whoever draws says from where; what is in view is refined from
 * the coarsest on, always the node whose points are farthest apart on the screen, until they are near enough or what is wanted fills the
 * memory. A node is drawn, or what stands below it and is in view, once all of that is there. Threads of the pager read what is
 * missing from the disk, in this order, then what will be in view when the camera goes on as it did, then what is around; what
 * was not wanted for longest makes room. Drawing never waits for what they read, but who draws with the processor takes turns with them:
 * scene_pager_let_read().
 *
 * A frame sees the chunks that its turn left, and nothing that it draws goes away before the next turn.
 *
 * Threads: turns and settling on one thread at a time, the one that draws. Others that read the scene's points or chunks do so between
 * scene_pager_hold and scene_pager_release, which turns wait for. What is wrong with the file is told once, by scene_pager_error
 * or scene_pager_settle; what cannot be read stays coarse. */
#include "render/camera.h"
#include "render/scene.h"

/* Points, with all that there is of each. */
#define SCENE_PAGER_POINT_BYTES (SCENE_POINT_BYTES + 6u)
/* A pager takes at least this much memory beside the tops. */
#define SCENE_PAGER_LEAST ((uint64_t)16 << 20)

typedef struct scene_pager scene_pager;
/* For scene_new_within and tests: a scene of a model that is told in short, with a pager. */
scene *scene_paged(
	const model *m, const uint8_t *leaf_class, uint64_t memory_bytes, GError **error);
void scene_pager_free(scene_pager *p); /* NULL is fine; stops the threads */
/* For who keeps copies: chunks begin at multiples of so many points, and none stands across a multiple of SCENE_PAGER_WITHIN. All indices
 * are below scene_pager_points(). */
#define SCENE_PAGER_ALIGNED 8u
#define SCENE_PAGER_WITHIN  (1u << 16)
uint32_t scene_pager_points(const scene_pager *p);
/* For scene_owner_of. */
struct scene_owner scene_pager_owner_of(const scene_pager *p, uint32_t id);
size_t scene_pager_bytes(const scene_pager *p); /* that it may take */
/* The boxes of all chunks of the file, from the scene's origin. */
void scene_pager_boxes(const scene_pager *p,
	void (*visit)(
		uint32_t leaf, const float centre_m[3], const float half_m[3], gpointer user_data),
	gpointer user_data);

struct scene_look {
	const struct camera *camera;
	float ink_px; /* frame.h: strokes reach beyond the picture by that */
	/* Another one will follow soon, of a camera that goes on so; else as finely as can be seen. */
	bool is_moving;
	/* Until scene_pager_let_read nothing is read: the frame is drawn by the processor, which then has nothing else to do. */
	bool is_quiet;
};
struct scene_turned {
	uint64_t points; /* in view, that are drawn */
	uint64_t
		points_missing; /* and that would be, more than those, were all there that is wanted */
	uint32_t missing;       /* nodes that are not there yet; 0: the view is complete */
	bool is_whole;          /* all points in view are there */
};
/* ret may be NULL. */
void scene_pager_turn(scene_pager *p, const struct scene_look *look, struct scene_turned *ret);
/* After each frame of a quiet turn, once it is shown; after others nothing is done. Reads until all that is missing is there or it is time
 * for the next frame: of these there are 30 in a second while points in view are missing, else they wait for a third of the time that the
 * last one took. */
void scene_pager_let_read(scene_pager *p);
/* Turns until a view that does not move is complete: with all points in view, where they fit into the memory, and what is drawn then is
 * what would be without a pager; else as finely as can be seen, or fits. The same whatever was there before. */
bool scene_pager_settle(scene_pager *p, const struct scene_look *look, GError **error);
/* The same of any scene, for a frame that is to be drawn; nothing is done without a pager. */
bool scene_pager_settle_for(const scene *s, const struct camera *c, float ink_px, GError **error);
/* Calls back, on any thread and soon, under a lock of the pager's, whenever something has come that a turn would take. */
/* came NULL: no more; it is not called any longer then. */
void scene_pager_watch(scene_pager *p, void (*came)(gpointer user_data), gpointer user_data);
/* What was wrong since it was last asked; NULL: nothing. Caller frees. */
GError *scene_pager_error(scene_pager *p);

/* Of any scene. */
void scene_pager_hold(const scene *s);
void scene_pager_release(const scene *s);

/* For benches and tests. */
struct scene_pager_sums {
	uint64_t bytes_read, nodes_read;
	uint32_t units, units_most; /* of memory, taken and at most */
};
struct scene_pager_sums scene_pager_sums(scene_pager *p);

#endif
