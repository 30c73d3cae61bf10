#ifndef RENDER_STROKE_H
#define RENDER_STROKE_H
/* The strokes of a frame, as they are drawn: the points of each layer that are dense enough on the screen for it (Xu & Chen 2004,
 * sections 6.2 to 7.4) and not hidden by the mask. Sprites and line segments are strokes too.
 *
 * Where that asks for more strokes than there are points, points of surface give some more that lie scattered in their patches: the
 * copies, whose ranks are behind those of all points.
 *
 * A point is drawn when its rank among its kind in its chunk is below what the density at its very place asks for, and fades in over
 * the last half of its rank, or more near the eye. So density is even, and whatever is drawn in one frame is drawn in the next. */
#include "render/mask.h"
#include "render/stroke-pack.h"

/* The strokes of a frame stand in blocks, in memory that one frame leaves to the next. */
#define STROKE_BLOCK 96u
/* Rows that a stroke may touch, from top to before end, counted from the row that is so many above the picture: what is farther up, or
 * below all pictures, is at the end of the scale. */
#define STROKE_SPAN_ABOVE 16
#define STROKE_SPAN_MOST  65000
_Static_assert(CAMERA_SIDE_MAX + STROKE_SPAN_ABOVE < STROKE_SPAN_MOST, "all rows are on the scale");
struct stroke_span {
	uint16_t top, end;
};
struct stroke_block {
	struct stroke_block *next; /* of the same layer */
	uint32_t first, count;     /* strokes before it, and in it */
	struct stroke_span span[STROKE_BLOCK];
	struct stroke_packed stroke[STROKE_BLOCK];
};
typedef struct stroke_room stroke_room;
stroke_room *stroke_room_new(void);
void stroke_room_free(stroke_room *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(stroke_room, stroke_room_free)

/* Strokes of one layer, in the order of chunk_views and ranks. */
struct stroke_blocks {
	struct stroke_block **block;
	uint32_t blocks, count;
};
/* Of all layers of the frame: f->layers of them, which are the room's, until it is asked again. m may be NULL: nothing is hidden. */
const struct stroke_blocks *stroke_room_fill(stroke_room *r, const frame *f,
	const visibility_mask *m, const struct chunk_view *views, uint32_t count);

/* Only of the layers whose bits are set; the others have none. */
const struct stroke_blocks *stroke_room_fill_some(stroke_room *r, const frame *f,
	const visibility_mask *m, const struct chunk_view *views, uint32_t count, uint64_t which);
_Static_assert(FRAME_LAYERS_MAX <= 64, "a bit for each");

/* The same in one piece. */
typedef struct stroke_list stroke_list;
struct stroke_list {
	struct stroke *stroke;
	uint32_t count;
};
/* An array of f->layers lists. Free with stroke_lists_free. */
stroke_list *stroke_lists_new(
	const frame *f, const visibility_mask *m, const struct chunk_view *views, uint32_t count);
void stroke_lists_free(stroke_list *lists, uint32_t layers); /* NULL is fine */

/* Copies lie so much farther away than points are moved: their rows are farther apart than patches are long where beams graze. */
#define COPY_REACH 1.3f
/* Strokes that a point gives at most which stands for leaves or clutter: more of them fill its patch, and it looks like a board. */
#define LEAVES_COPIES 8u
/* Parts of the patch that each copy lies farther than the one before, across and down, beginning again at its border: so they keep apart
 * from each other (Roberts 2018, "The Unreasonable Effectiveness of Quasirandom Sequences"). */
#define COPY_ACROSS 0.7548777f
#define COPY_DOWN   0.5698403f
/* Along each of two axes, in diameters of the patch. */
static inline float stroke_reach(float scatter, uint32_t copy)
{
	return scatter * (copy ? COPY_REACH : 1) / 2;
}
/* From any point of the chunk. */
static inline float stroke_moved_most_m(const struct scene_chunk *c, float scatter, uint32_t copy)
{
	return c->disc_most_m * stroke_reach(scatter, copy) * (float)G_SQRT2;
}

/* What depends on chance, of one stroke: a salt of its own. */
enum {
	SALT_LAY,
	SALT_LENGTH,
	SALT_ANGLE,
	SALT_OPACITY,
	SALT_VARIANT,
	SALT_ACROSS,
	SALT_DOWN,
	SALT_SHADE,
	SALTS = 8,
	/* Of points alone. */
	SALT_CROSS = 1 << 16,
	SALT_PENCIL,
	SALT_WARMTH,
	SALT_HUE
};
static inline uint32_t stroke_salt(uint32_t copy, uint32_t salt)
{
	return copy * SALTS + salt;
}
/* 0 <= r < 1, of a point; another one for each salt. */
static inline float stroke_chance(uint32_t point, uint32_t salt)
{
	uint32_t x = point * 0x9E3779B9u ^ salt * 0x85EBCA6Bu;
	x ^= x >> 16;
	x *= 0x7feb352du;
	x ^= x >> 15;
	x *= 0x846ca68bu;
	x ^= x >> 16;
	return (float)(x >> 8) * (1.f / (1 << 24));
}

/* What a layer's strokes at full need weigh less for fading in: the mean of stroke_fade over ranks. */
#define STROKE_FADE_MEAN 0.7213f
/* Octaves of need that a point comes in over: one, and more of them near the eye, where a step changes need much. */
#define STROKE_FADE_NEAR_M 21.5f
#define STROKE_FADE_MOST   5.66f
static inline float stroke_fade_octaves(float depth_m)
{
	float octaves = STROKE_FADE_NEAR_M / depth_m;
	return octaves < 1 ? 1 : octaves > STROKE_FADE_MOST ? STROKE_FADE_MOST : octaves;
}
/* What need must be more for them: the mean of stroke_fade is (1 - 2^-octaves) / (octaves ln 2). Within 0.1 % of that. */
#define STROKE_FADE_MORE(octaves)                                                                  \
	(1 + ((octaves)-1) * (0.307f + ((octaves)-1) * (0.028f - 0.0015f * ((octaves)-1))))
/* Of a point with this rank where need is wanted: 1 at need / 2^octaves and below, 0 at need. Even steps when the scale grows evenly. */
static inline float stroke_fade(float rank, float need, float octaves)
{
	if (rank >= need)
		return 0;
	float fade = __builtin_log2f(need / rank) / octaves;
	return fade < 1 ? fade : 1;
}

/* How deep a pixel may be for a stroke of paint to be there, as parts of the depth of its plane. */
struct stroke_reach {
	float from, to;
};
static inline struct stroke_reach stroke_paint_reach(
	const struct frame_paint *p, const struct stroke *s)
{
	float right = __builtin_fabsf(s->along[0]), down = __builtin_fabsf(s->along[1]);
	float slack = PAINT_PLANE_ROUGH *
		      (__builtin_fabsf(s->slope[0]) *
				      (right * s->half_length_px + down * s->half_width_px) +
			      __builtin_fabsf(s->slope[1]) *
				      (down * s->half_length_px + right * s->half_width_px)) /
		      s->q;
	if (slack > PAINT_ROUGH_MOST)
		slack = PAINT_ROUGH_MOST;
	return (struct stroke_reach){ 1 - slack, p->behind + p->behind_m * s->q + slack };
}

/* What 1/depth of a stroke, times the depth of a pixel, must be for it to show there: 1, but for what reaches over leaves. */
#define STROKE_REACH_MOST 0.5f
static inline float stroke_shows_from(const struct frame_layer *l, const struct stroke *s)
{
	float reach = l->ink.reach_m * s->q;
	return 1 - (reach < STROKE_REACH_MOST ? reach : STROKE_REACH_MOST);
}

/* How much larger strokes must be to be as dark as wanted where need is more than there are points for. */
float stroke_growth(float need);

#endif
