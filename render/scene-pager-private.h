#ifndef RENDER_SCENE_PAGER_PRIVATE_H
#define RENDER_SCENE_PAGER_PRIVATE_H
/* What a pager is made of: scene-pager.c has its memory and its threads, scene-refine.c chooses. */
#include "render/scene-load.h"
#include "render/scene-pager.h"
#include "render/scene-units.h"

/* Of a node. */
struct page {
	uint32_t wanted; /* the last turn that wanted it */
	uint32_t split;  /* the last turn that drew what is below it instead */
	float apart_m;   /* its points from each other, as they are usual */
	/* Of the thread that draws. */
	bool is_there;  /* its points are in the scene */
	bool is_broken; /* they cannot be read */
	/* Under the lock. */
	uint8_t state; /* enum page_state */
	uint8_t order;
	uint32_t unit;
};
enum page_state { PAGE_AWAY, PAGE_COMING, PAGE_CAME, PAGE_THERE, PAGE_BROKEN };

struct heap_entry {
	float sparse; /* how much farther apart its points are than they should be */
	uint32_t node;
};

struct scene_pager {
	scene *scene;
	struct scene_source source;
	scene_tree *tree;
	uint8_t *leaf_class; /* what grey points to */
	struct scene_grey grey;
	size_t bytes;
	struct page *page; /* of each node */
	/* Of each node that is there. */
	struct scene_chunk *chunk;
	struct scene_list_ends *list_ends;
	GRWLock reading; /* of those that hold it, and turns */

	/* Of the thread that draws. */
	uint32_t turn;
	uint32_t *seen; /* of each top: the last turn that had it in view */
	GArray *heap;   /* of struct heap_entry */
	GArray *wants; /* of uint32_t: nodes that are not there, in the order that they are wanted in */
	uint32_t wanted_units;
	GArray *there;   /* of uint32_t: nodes that may go again */
	bool forgets;    /* the next turn begins with the tops alone */
	uint32_t room;   /* chunks that the scene has memory for */
	uint64_t choice; /* a sum over the scene's chunks: others have another one */
	gint64 began_us; /* the last turn */
	bool missed;     /* points in view */
	struct {
		bool is_known;
		struct camera camera;
		gint64 at_us;
		double speed_m_s[3], turn_rad_s;
	} last;

	/* Under the lock. */
	GMutex lock;
	GCond work, done;
	scene_units *units;
	uint32_t first_unit; /* point of the scene that the first unit begins with */
	GArray *asked;       /* as wants, of the last turn */
	guint next;          /* of these */
	GArray *came;        /* of uint32_t */
	uint32_t coming, active_most, stamp;
	bool is_starved; /* there was no block of the size that was needed */
	bool quit;
	int is_quiet; /* atomic: nothing is read now */
	GError *error;
	uint64_t bytes_read, nodes_read;
	void (*watch)(gpointer user_data);
	gpointer watch_data;

	uint32_t threads;
	GThread **thread;
};

/* Which nodes to draw and to want; makes the scene's chunks of the former. */
void scene_refine(scene_pager *p, const struct scene_look *look, struct scene_turned *ret);
/* Wants what the camera will see as it goes on, and what is around it. */
void scene_refine_ahead(scene_pager *p, const struct scene_look *look);

#endif
