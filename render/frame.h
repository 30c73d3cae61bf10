#ifndef RENDER_FRAME_H
#define RENDER_FRAME_H
/* One frame to draw: a scene, a style for its leaves, one camera, and what is derived of them once. All segments of a frame are drawn
 * from the same snapshot, on either backend. */
#include "process/segments.h"
#include "render/camera.h"
#include "render/frame-hatch.h"
#include "render/frame-nets.h"
#include "render/frame-paint.h"
#include "render/lanes-path.h"
#include "render/lens.h"
#include "render/paper-texture.h"
#include "render/scene.h"
#include "render/stroke-texture.h"
#include "render/style.h"

#include <math.h>

#define FRAME_LAYERS_MAX   64
#define FRAME_THREADS_MOST 64
/* Height of the pictures that lengths in styles are for. */
#define FRAME_STYLE_HEIGHT 1200.0

/* How a layer takes on the style's light. */
enum frame_lit {
	LIT_NOT,
	LIT_TONE, /* points count as darker than they are */
	LIT_OMITTED, /* where it is light, strokes of one ink are left out (Wagner et al. 2022, section 3.3) */
	LIT_COLOUR, /* the points' colours are darker */
};
struct frame_light {
	float amount;  /* 0: there is none */
	float from[3]; /* the unit vector towards it, as the camera sees it */
	double site_from[3];
};
struct frame_focus {
	bool is_there;
	int32_t on; /* enum style_focus_on */
	float amount, abstraction, filters;
	/* 1 / falloff; of FOCUS_PICTURE both are of rays, at depth 1. */
	float radius_m, per_m;
	float at_m[3]; /* as the camera sees it */
	struct lens lens;
	double site_m[3];
	float across, down, radius_px, falloff_px; /* of the style */
};

/* A layer of one pipeline, with lengths in the picture's pixels. */
struct frame_layer {
	const struct step *step;
	uint8_t pipeline;
	uint32_t kinds; /* a bit for each enum feature_kind that it draws */
	struct ink_step ink;
	bool is_focus;                      /* it draws what the style's focus is on */
	const struct stipple_step *stipple; /* NULL: density chooses; else stipple.h */
	stroke_texture *texture;            /* NULL: none; of about the size on the screen */
	/* The texture, four neighbouring texels in one, with nothing beyond its borders: rows of 2^texel_shift, variants below each other. */
	uint32_t *texels, texel_shift;
	uint8_t *few_texels; /* the same, one by one, if there are so few (frame_pack_few_texels) */
	float stroke_area_px; /* integral of a mean stroke's alpha */
	enum frame_lit lit;
	bool is_queue; /* INK_DITHERING and TONE_COLOUR: dithering points, and behind them all others */
	/* Bits of kinds whose points share the places of strokes, as dense as all points are; those of other kinds are as dense as there are
	 * points of their own. */
	uint32_t together;
	bool dithers_alone; /* or before all others: with the spacing of dithering points */
	float wanted_most
		[FEATURE_KINDS]; /* of a kind, at any lightness; where it is a queue, for all dithering points of black surface */
	/* The same of points as light as a list has them in one of its parts (scene_list_tone()); and dithering points that there are to a
	 * square metre before any of them is drawn, at least: 0 where there is no queue. */
	float wanted_of_tone[FEATURE_KINDS][SCENE_LIST_TONES];
	float before_of_tone[FEATURE_KINDS][SCENE_LIST_TONES];
	float wanted_per_px[256];    /* strokes to a square pixel, by lightness of the points */
	float dithering_per_m2[256]; /* points that there are, by their lightness; more than 0 */
	float ink_linear[3];
	struct frame_hatch *hatch; /* NULL: it is no hatching */
	bool is_contours, is_cut, is_profile;
	struct frame_paint *
		paint; /* NULL: it is none; its textures are of all sizes, and the layer's own is NULL */
	const uint8_t (*bend)[2]; /* scene-bend.h; NULL: nothing is bent, as far as it matters */
	/* Directions on the screen, x right and y down: the layer's own, and 256 turns within its variation, as cosine and sine. */
	float own_way[2], turn[256][2];
};

/* Whether points of this kind lie on surface, may be moved in it, and give copies; so do all that are drawn together with surface. */
static inline bool frame_layer_has_surface(const struct frame_layer *l, int kind)
{
	return kind < FEATURE_UNDIRECTED || l->together >> kind & 1;
}

/* All points are surface to it, whatever kind they are of. */
static inline bool frame_layer_is_whole(const struct frame_layer *l)
{
	return l->hatch || l->is_contours || l->is_cut || l->paint;
}

/* In one variant: a row more than there are between texels, and a column. */
static inline size_t frame_texels(const stroke_texture *t, uint32_t texel_shift)
{
	return (size_t)(t->width + 2) << texel_shift;
}
/* As texels of a layer are; g_free. */
uint32_t *frame_pack_texels(const stroke_texture *t, uint32_t *ret_shift);
/* What four of the largest registers hold, in no more than 62 columns. */
#define FRAME_FEW_TEXELS 256u
/* Of each variant, in so many bytes: a border of nothing around it, rows of length + 2; g_free. NULL: they are more than few. */
uint8_t *frame_pack_few_texels(const stroke_texture *t);

/* Strokes that a point of surface with a normal gives at most: itself and its copies. */
uint32_t frame_copies(const struct frame_layer *l);
/* How far apart dithering points of black surface are, where a layer draws them alone; else 0. */
float frame_dither_m(const scene *s, const struct frame_layer *l, const struct scene_chunk *c);

typedef struct frame frame;
struct frame {
	uint64_t serial; /* scene_serial(): of all but the camera */
	const scene *scene;
	const drawing *drawing;
	struct camera camera;
	struct step cut; /* of pipelines that have none of their own, where the camera cuts */
	float px;        /* pixels of the picture to one of the style's */
	float ink_px;    /* the same for strokes: more where they are coarser */
	double eye_m[3]; /* from the scene's origin */
	struct frame_light light;
	struct frame_focus focus;
	struct frame_layer *layer; /* inks, in the order in which they are drawn */
	uint32_t layers;
	paper_texture *paper;
	uint8_t *
		relief; /* of that, of what the camera draws: width x height, PAPER_TEXTURE_MEAN is flat */
	uint32_t relief_width, relief_height;
	uint64_t relief_serial; /* scene_serial() */
	enum lanes_path lanes;  /* with what vectors cpu draws it; tests try them all */
	bool single_thread;     /* for tests */
	double time_s;          /* of what moves by itself */
	/* Pipelines whose filters are the same are drawn together, as one sheet (frame-sheets.h). */
	bool is_painted;  /* some layer is paint */
	bool is_filtered; /* some sheet has filters, or the picture; else there is one sheet */
	uint32_t sheets;
	uint8_t sheet_of[PIPELINES_MAX + 1];
	frame_nets *nets; /* NULL: none is wanted */
	/* NULL, or becomes other than 0 (g_atomic_int_set, any thread) when nobody wants the picture any more: it is then left unfinished. */
	const int *stop;
};
static inline bool frame_is_stopped(const struct frame *f)
{
	return f->stop && g_atomic_int_get(f->stop);
}

/* Scene and drawing must live longer. Where the camera cuts, what pipelines have no step for is cut with lines over all else, dark on
 * light paper and light on dark. Errors of camera_validate, missing textures, more layers than FRAME_LAYERS_MAX. */
frame *frame_new(const scene *s, const drawing *d, const struct camera *c, GError **error);
/* With strokes that are so much larger (at least 1), and fewer: of a small picture of a moving view nobody sees finer ones, and it is
 * drawn the sooner. Tones are the same. */
frame *frame_new_coarse(
	const scene *s, const drawing *d, const struct camera *c, double coarser, GError **error);
void frame_free(frame *f); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(frame, frame_free)
/* Another camera with a picture of the same size, or a window of one, which cuts if the first one did; the layers stay. What is drawn of
 * windows is what is drawn of the whole picture there (poster.h tells how far from their edges). */
bool frame_move(frame *f, const struct camera *c, GError **error);

/* The same with the camera that f->camera is a window of: to look at, while f is there. */
static inline frame frame_of_whole(const frame *f)
{
	frame ret = *f;
	ret.camera = camera_whole(&f->camera);
	return ret;
}

/* Another light or focus than the drawing's. */
void frame_set_light(frame *f, const struct style_light *light);
void frame_set_focus(frame *f, const struct style_focus *focus);
/* How light a surface is in the light: 1 where it faces it, 0 where it turns its back to it, and even steps of the cosine between, so that
 * things are round in the shade too. The unit normal as the camera sees it; 0 0 0 where there is none, as leaves have it. */
static inline float frame_diffuse(const struct frame_light *l, const float normal[3])
{
	float along = normal[0] * l->from[0] + normal[1] * l->from[1] + normal[2] * l->from[2];
	return 0.5f + 0.5f * along;
}

/* 0..1: how far a place is from the focus, as the camera sees it; is_focus: it is of the segment that the focus is on. */
static inline float frame_away(const struct frame_focus *focus, const float at_m[3], bool is_focus)
{
	float away2 = 0;
	if (!focus->is_there)
		return 0;
	if (focus->on == FOCUS_SEGMENT)
		return is_focus ? 0 : 1;
	float deep[3] = { LENS_SCALE_M(&focus->lens, at_m[2]), deep[0], at_m[2] };
	for (int k = 0; k < 3; k++) {
		float at = focus->on == FOCUS_PLACE ? at_m[k] : at_m[k] / deep[k];
		away2 += (at - focus->at_m[k]) * (at - focus->at_m[k]);
	}
	float part = (sqrtf(away2) - focus->radius_m) * focus->per_m;
	part = CLAMP(part, 0, 1);
	return part * part * (3 - 2 * part);
}

/* The unit vector towards the light that falls on paint, on the screen: the style's, or from the left above as painters have it. */
void frame_paint_light(const frame *f, float ret[3]);
/* The middle of what the chunk is of, as the camera sees it; of scenes that are painted. */
void frame_paint_crown(const frame *f, const struct scene_chunk *c, float ret_m[3]);

/* Pixels that neighbouring points are apart at a depth, where they are as many as is usual in this scene. */
static inline float frame_apart_px(const frame *f, float depth_m)
{
	return f->scene->spacing_median_m * (float)f->camera.focal_px /
	       camera_scale_f(&f->camera, depth_m);
}

/* Threads that cpu draws it with. */
uint32_t frame_threads(const frame *f);

/* So much more do strokes cover than if they fell by chance: they stand more evenly, so fewer lie on others (measured). */
#define FRAME_EVENLY 1.04f
/* Of strokes among leaves, that is with reach_m: some of each is hidden, and leaves have gaps between them (measured). */
#define FRAME_AMONG_LEAVES 0.785f
static inline float frame_evenly(const struct frame_layer *l)
{
	return l->ink.reach_m > 0 ? FRAME_AMONG_LEAVES : FRAME_EVENLY;
}
/* Strokes of a layer to a square pixel that there ever are. */
float frame_most_per_px(const struct frame_layer *l);
/* What so many strokes of a layer let through of the paper's light: about exp(-number * area) of it stays bare. */
float frame_light_of(const struct frame_layer *l, float strokes_per_px);
/* What a layer of TONE_COLOUR should let through where points have this lightness (0..1). Tones that are too dark for its strokes, which
 * stand no closer than spacing_px, come near the darkest that they can be. */
float frame_wanted_light(const struct frame_layer *l, const scene *s, float lightness);

static inline const struct pipeline *frame_pipeline(const frame *f, uint32_t pipeline)
{
	return &g_array_index(f->drawing->pipelines, struct pipeline, pipeline);
}

/* Filters of a sheet, which are those of all of its pipelines. */
const struct step *frame_filters(const frame *f, uint32_t sheet, uint32_t *ret_count);
/* How the changes of a sheet's filters get their depths. */
const struct inpaint_step *frame_inpaint(const frame *f, uint32_t sheet);
/* Layers that are drawn over what filters made, or those below; a bit for each. */
uint64_t frame_layers_over(const frame *f, bool over);

/* Whether plane surfaces are drawn in place of their points. */
static inline bool frame_has_planes(const frame *f, uint32_t pipeline)
{
	return f->scene->planes && frame_pipeline(f, pipeline)->mask.planes;
}

/* The first step of that kind in a pipeline; NULL: it has none. */
const struct step *frame_step(const frame *f, uint32_t pipeline, const char *kind_name);

/* Length of the longest ray of depth 1 to a place where a stroke of the layer may be seen; NULL: to any place of the picture. */
float frame_ray_most(const frame *f, const struct frame_layer *l);

/* A drawn picture: sRGB, 4 bytes a pixel, row by row, the last 255. */
struct picture_buffer {
	uint32_t width, height;
	uint8_t (*rgba)[4];
};

#endif
