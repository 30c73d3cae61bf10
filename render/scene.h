#ifndef RENDER_SCENE_H
#define RENDER_SCENE_H
/* The points of a site in the form that both backends draw them from: the model's chunks (process/model.h) in their order, attributes
 * apart, positions in 16 bits of each chunk's box; 28 bytes a point. Any first part of a chunk is a uniform subset of its points: the
 * continuous resolution queue (Xu & Chen 2004, sections 6.3 and 7.4). Layers are drawn from lists of the points of each kind, which have
 * ranks of their own.
 *
 * Where that is more than memory may be taken, some of it is there at a time (scene-pager.h), and all else as some points of many
 * chunks together: the chunks are then those that the last turn has chosen, in view as fine as they are there and wanted, and
 * beside it coarse. They are in the order of the model's.
 *
 * Const after it was made: any number of threads may read. Of a scene with a pager whoever draws makes the turns, between its own frames,
 * and others that read hold scene_pager_hold meanwhile. */
#include "process/features.h"
#include "process/model.h"
#include "process/profile-lines.h"

/* Of lengths in it, unit_m: as the model has them; or so, where most points stand farther apart than it can say. */
#define SCENE_UNIT_M     1e-4f
#define SCENE_UNIT_FAR_M 1e-2f
/* Of a scene without a pager: indices of points are so many at most. */
#define SCENE_POINTS_MOST (INT32_MAX - 4096u)
#define SCENE_POINT_BYTES 28u
/* Of each kind in a chunk, and of each tone of the kind. */
#define SCENE_LIST_TONES 4
#define SCENE_LIST_STEPS 16

/* Of a point: where it is in the box of its chunk, and the edge of the square of surface that it stands for, in units. */
struct scene_place {
	uint16_t q[3], spacing;
};

/* Of a chunk's part of list: where its points of each kind and tone end that have a key of so many steps (scene-list.h). */
struct scene_list_ends {
	uint16_t end[FEATURE_KINDS][SCENE_LIST_TONES][SCENE_LIST_STEPS]; /* from first on */
	int32_t last[FEATURE_KINDS][SCENE_LIST_TONES]; /* the step that the last of them has */
};

struct scene_chunk {
	float centre_m[3]; /* from the scene's origin */
	float half_m[3];   /* of its box */
	float step_m[3];   /* position = centre - half + step * q */
	float spacing_least_m, spacing_most_m, disc_most_m;
	uint32_t first, count;
	uint32_t leaf;
	float part; /* 1; less where these points stand for others too, which are not among them: so many of all */
	uint32_t stamp; /* of a pager: whenever other points stand where these do, another one */
	bool is_aside;  /* the last turn has it out of view: it is not drawn */
	uint32_t on_planes; /* of its points: those that planes stand for (scene-planes.h) */
	float list_spacing_most_m[FEATURE_KINDS];
	uint32_t kind_end[FEATURE_KINDS];  /* of its part of list, from first on */
	struct scene_list_ends *list_ends; /* its own, of its scene or of a pager */
};

typedef struct scene scene;
struct scene {
	uint64_t serial; /* scene_serial(): what is kept of it elsewhere is known by it */
	double origin_m[3];
	float unit_m;
	float spacing_median_m; /* of some of its points, from all over it */
	uint32_t count, chunks;
	struct scene_chunk *chunk;
	struct scene_list_ends *list_ends; /* of each chunk; NULL: a pager has them */
	struct scene_bend_plane *bend;     /* scene-bend.h */
	struct scene_paint_plane *paint;   /* scene-paint.h */
	struct scene_lines *lines;         /* scene-lines.h; NULL: none are known */
	struct scene_planes *planes;       /* scene-planes.h; NULL: there are none */
	struct scene_pager *pager;         /* NULL: all points are there */
	uint32_t turn;                     /* of the pager: rises when the chunks become others */
	void *memory;                      /* of all that follows */
	/* Of each point. */
	struct scene_place *place;
	uint16_t *
		disc; /* diameter that covers its patch, the long way where it is slanted, in units, saturates at 32767; and SCENE_DISC_PLANE */
	int16_t (*normal)[2]; /* packed (model.h) */
	/* Of its line; of other points than feature points the one in which the surface is bent most. None: MODEL_NORMAL_NONE. */
	int16_t (*direction)[2];
	uint8_t (*rgba)
		[4]; /* sRGB; of intensities where there is no colour (scene-grey.h); a 0: has neither */
	uint8_t *kind, *degree;
	/* Of each chunk: its points kind by kind, those first that are drawn from far away (scene-list.h). */
	uint32_t *list;
	uint32_t *id; /* with a pager: which point of the model it is; NULL: that of its index */
	/* Of coloured points, 0..1: a twentieth is darker, a twentieth is lighter; 0 and 1 without any. */
	float darkest, lightest;
	float dither_per_m2, tone_exponent; /* that the dithering points were chosen with */
};
/* How much longer dark places are exposed, so that their lightest points are about as light as those of others are: 1 with exposure 0,
 * and where they are light enough; with exposure 1 all of it. */
float scene_exposure_of(const scene *s, float exposure);
/* sRGB, 0..1, of one or of lanes of them: black stays black and white white, and what is dark becomes so many times as light. */
#define SCENE_EXPOSED(times, srgb) ((srgb) * (times) / (1 + ((times)-1) * (srgb)))
static inline float scene_exposed(float times, float srgb)
{
	return SCENE_EXPOSED(times, srgb);
}

/* Reads all of the model once, and gives its memory back behind itself; the model must stay as long as the scene, for what is read of it
 * later (scene-bend.h). G_IO_ERROR_NO_SPACE when it is too large: 2^31 points. */
scene *scene_new(const model *m, GError **error);
/* The same where that takes no more memory than so; else with a pager, which takes no more than that or the least that it can do with (SCENE_PAGER_LEAST). 0: half of the machine's memory. A model that is not told in short (process/model.h) is read whole.
 * leaf_class: as segments_classes() has them, for points without a colour (scene-grey.h) and for leaves (scene-foliage.h); NULL: the former
 * are grey, the latter stand for what their beams claim. */
scene *scene_new_within(
	const model *m, const uint8_t *leaf_class, uint64_t memory_bytes, GError **error);
/* Room for so many points and chunks, to be filled by whoever made it; chunks and lists are 0, all else is not yet written. */
scene *scene_alloc(uint32_t count, uint32_t chunks);
/* The profile lines of its site, before it is drawn. */
void scene_set_lines(scene *s, const profile_lines *lines);
void scene_free(scene *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scene, scene_free)
size_t scene_bytes(const scene *s); /* of memory */
/* Another number at each call, never 0; any thread. */
uint64_t scene_serial(void);

/* Of a point's colour, as the eye weighs it; without one 128. */
static inline uint8_t scene_lightness(const uint8_t rgba[4])
{
	return rgba[3] ? model_lightness(rgba) : 128;
}

/* What chance knows a point by: the same whenever it is there. */
static inline uint32_t scene_id(const scene *s, uint32_t point)
{
	return s->id ? s->id[point] : point;
}

/* The chunk of the model that has the point with this id: ids from first on, below end. All 0: none has. */
struct scene_owner {
	uint32_t first, end, leaf;
};
struct scene_owner scene_owner_of(const scene *s, uint32_t id);

static inline void scene_position(
	const scene *s, const struct scene_chunk *c, uint32_t i, double ret_m[3])
{
	for (int k = 0; k < 3; k++)
		ret_m[k] = s->origin_m[k] + c->centre_m[k] - c->half_m[k] +
			   c->step_m[k] * s->place[c->first + i].q[k];
}

#endif
