#include "render/vector-page.h"
#include "render/light.h"
#include "render/scene-lines.h"
#include "render/splat.h"
#include "render/vector-coats.h"
#include "render/vector-run.h"
#include <math.h>
#include <string.h>

/* Steps of opacity, of colours, and of widths: each so much broader than the last. */
#define SHADES      8
#define COLOURS     16
#define WIDTH_RATIO 1.08f
/* What is shorter is not seen on a page. */
#define FINE_MM 0.25f
/* Cells of coats, in the style's pixels. */
#define COAT_CELL 0.6f

/* ---- memory ---- */

static void path_free(void *data)
{
	struct vector_path *p = data;
	g_array_unref(p->corner);
	g_array_unref(p->end);
	g_free(p);
}

static void group_free(void *data)
{
	struct vector_group *g = data;
	g_ptr_array_unref(g->paths);
	g_free(g->name);
	g_free(g);
}

static void layer_free(void *data)
{
	struct vector_layer *l = data;
	g_ptr_array_unref(l->groups);
	g_free(l->name);
	g_free(l);
}

void vector_page_free(vector_page *p)
{
	if (!p)
		return;
	picture_buffer_clear(&p->ground);
	g_ptr_array_unref(p->layers);
	g_free(p->title);
	g_free(p);
}

/* ---- looks ---- */

/* What paths of a group differ by. */
union look {
	struct {
		uint16_t segment;
		int16_t width; /* step */
		uint8_t coat, shade, rgb[3];
	};
	uint64_t words[2];
};

struct hand {
	const frame *f;
	const struct frame_layer *from;
	struct vector_shaper shaper;
	struct vector_layer *to;
	vector_coats *coats;
	const segments *tree;
	float mm_per_px;
	float part; /* of the strokes have shapes, so much broader each, and so many layers of ink */
	float broader, layers;
	struct scene_owner owner; /* of the last stroke */
	GHashTable *groups;       /* by segment */
	GHashTable *paths;        /* by look; those that are not full */
};

static guint look_hash(gconstpointer key)
{
	const union look *l = key;
	uint64_t h = (l->words[0] ^ l->words[1] * 0x9E3779B97F4A7C15u) * 0xD6E8FEB86659FD93u;
	return (guint)(h >> 32);
}

static gboolean look_equal(gconstpointer a, gconstpointer b)
{
	const union look *x = a, *y = b;
	return x->words[0] == y->words[0] && x->words[1] == y->words[1];
}

/* The step below or above, by chance, so that the mean stays. */
static int step_of(float value, const struct stroke *s, uint32_t salt)
{
	return (int)floorf(value + stroke_chance(s->point ^ salt * 0x5bd1e995u,
					   stroke_salt(s->copy, SALT_SHADE)));
}

static bool is_left_out(const struct hand *h, const struct stroke *s)
{
	return h->part < 1 && stroke_chance(s->point ^ 9 * 0x5bd1e995u,
				      stroke_salt(s->copy, SALT_SHADE)) >= h->part;
}

/* What is to be mixed in sRGB so that one shape on white is as light as the painter's. */
static float opacity_of(const struct hand *h, float alpha)
{
	float ink = h->to->blend == VECTOR_COVER ? 0 : light_luminance(h->from->ink_linear);
	float most = 1 - light_to_srgb(ink);
	return most > 0.01f ? (1 - light_to_srgb(1 - alpha * (1 - ink))) / most : 0;
}

static void set_colour(const struct hand *h, const struct stroke *s, float alpha, union look *l)
{
	const float *light = light_of_bytes();
	for (int k = 0; k < 3; k++) {
		float colour = h->to->blend == VECTOR_COVER
				       ? (float)s->rgb[k] / 255
				       : light_to_srgb(1 - alpha * (1 - light[s->rgb[k]]));
		int step = step_of(colour * (COLOURS - 1), s, 2);
		l->rgb[k] = (uint8_t)(CLAMP(step, 0, COLOURS - 1) * 255 / (COLOURS - 1));
	}
}

/* false: so faint that it is nothing. */
static bool look_of(const struct hand *h, const struct stroke *s, union look *ret)
{
	float alpha = vector_alpha(&h->shaper, s), width = vector_width_px(&h->shaper, s);
	if (h->layers > 1)
		alpha = 1 - powf(1 - alpha, h->layers);
	*ret = (union look){ .segment = (uint16_t)h->owner.leaf, .shade = SHADES };
	if (h->to->blend != VECTOR_EACH_DARK)
		ret->shade =
			(uint8_t)CLAMP(step_of(opacity_of(h, alpha) * SHADES, s, 0), 0, SHADES);
	if (h->to->blend != VECTOR_MULTIPLY)
		set_colour(h, s, alpha, ret);
	if (width > 0)
		ret->width = (int16_t)step_of(logf(width * h->mm_per_px) / logf(WIDTH_RATIO), s, 1);
	return ret->shade > 0;
}

/* ---- groups ---- */

static void find_chunk(struct hand *h, const struct stroke *s)
{
	const struct scene_owner *o = &h->owner;
	if (s->point < o->first || s->point >= o->end)
		h->owner = scene_owner_of(h->f->scene, s->point);
}

static struct vector_group *group_of(struct hand *h, uint32_t segment)
{
	struct vector_group *g = g_hash_table_lookup(h->groups, GUINT_TO_POINTER(segment));
	if (g)
		return g;
	g = g_new0(struct vector_group, 1);
	g->segment = segment;
	g->name = h->tree ? segments_name(h->tree, segment) : NULL;
	g->paths = g_ptr_array_new_with_free_func(path_free);
	g_hash_table_insert(h->groups, GUINT_TO_POINTER(segment), g);
	g_ptr_array_add(h->to->groups, g);
	return g;
}

static struct vector_path *path_of(struct hand *h, const union look *l)
{
	struct vector_path *p = g_hash_table_lookup(h->paths, l);
	if (p && p->end->len < VECTOR_PATH_SHAPES)
		return p;
	p = g_new0(struct vector_path, 1);
	p->width_mm = h->to->form == VECTOR_AREAS ? 0 : powf(WIDTH_RATIO, l->width);
	p->opacity = (float)l->shade / SHADES;
	for (int k = 0; k < 3; k++)
		p->rgb[k] = h->to->blend == VECTOR_MULTIPLY ? h->from->ink.ink[k] : l->rgb[k];
	p->corner = g_array_new(FALSE, FALSE, sizeof(float[2]));
	p->end = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_ptr_array_add(group_of(h, l->segment)->paths, p);
	g_hash_table_replace(h->paths, g_memdup2(l, sizeof *l), p);
	return p;
}

/* ---- strokes ---- */

static void add_shape(const struct hand *h, struct vector_path *p, const struct vector_shape *s)
{
	for (uint32_t n = 0; n < s->corners; n++) {
		float mm[2] = { s->corner[n][0] * h->mm_per_px, s->corner[n][1] * h->mm_per_px };
		g_array_append_val(p->corner, mm);
	}
	g_array_append_val(p->end, p->corner->len);
}

static void add_stroke(struct hand *h, const struct stroke *all)
{
	struct vector_shape part[VECTOR_PARTS_MOST];
	union look look;
	struct stroke broad = *all;
	const struct stroke *s = &broad;
	if (is_left_out(h, s))
		return;
	broad.half_width_px *= h->broader;
	uint32_t parts = vector_shapes_of(&h->shaper, s, part);
	find_chunk(h, s);
	if (!parts || !h->owner.end || !look_of(h, s, &look))
		return;
	look.coat = h->from->paint ? s->lay / (PAINT_LAYS / VECTOR_COATS)
				   : (uint8_t)vector_coats_take(h->coats, s, h->to->form,
					     vector_width_px(&h->shaper, s));
	struct vector_path *p = path_of(h, &look);
	for (uint32_t n = 0; n < parts; n++)
		add_shape(h, p, &part[n]);
	h->to->shown++;
}

/* ---- layers ---- */

static int compare_groups(gconstpointer a, gconstpointer b)
{
	const struct vector_group *const *x = a, *const *y = b;
	return (*x)->segment < (*y)->segment ? -1 : (*x)->segment > (*y)->segment;
}

/* "edges: Buildings, Structures": the step, and of which classes. */
static char *name_of(const struct hand *h)
{
	g_autoptr(GString) name = g_string_new(h->from->step->id);
	uint32_t classes = 0;
	for (guint n = 0; h->tree && n < h->to->groups->len; n++) {
		const struct vector_group *g = g_ptr_array_index(h->to->groups, n);
		const struct segment *s = segments_find(h->tree, g->segment);
		if (s && s->id != SEGMENT_SITE)
			classes |= 1u << s->class;
	}
	for (uint32_t class = 0, some = 0; class < SEGMENT_CLASSES; class ++)
		if (classes >> class & 1)
			g_string_append_printf(
				name, "%s%s", some++ ? ", " : ": ", segment_classes[class].title);
	return g_strdup(name->str);
}

static struct vector_layer *layer_new(const struct frame_layer *from, enum vector_form form)
{
	struct vector_layer *l = g_new0(struct vector_layer, 1);
	l->form = form;
	l->blend = from->ink.blend == BLEND_PAINT     ? VECTOR_COVER
		   : from->ink.colour == COLOUR_POINT ? VECTOR_EACH_DARK
						      : VECTOR_MULTIPLY;
	l->groups = g_ptr_array_new_with_free_func(group_free);
	return l;
}

/* Of paint, which hides what it lies on, one coat after the other: those that lie so high. */
static void add_strokes(struct hand *h, const struct stroke_blocks *strokes, uint32_t coat)
{
	for (uint32_t k = 0; k < strokes->blocks; k++)
		for (uint32_t n = 0; n < strokes->block[k]->count; n++) {
			struct stroke s = stroke_unpack(&strokes->block[k]->stroke[n]);
			if (!h->from->paint || s.lay / (PAINT_LAYS / VECTOR_COATS) == coat)
				add_stroke(h, &s);
		}
}

/* ---- runs of the pen ---- */

static struct stroke *all_of(const struct stroke_blocks *strokes)
{
	struct stroke *all = g_new(struct stroke, strokes->count + 1);
	for (uint32_t k = 0; k < strokes->blocks; k++) {
		const struct stroke_block *b = strokes->block[k];
		for (uint32_t n = 0; n < b->count; n++)
			all[b->first + n] = stroke_unpack(&b->stroke[n]);
	}
	return all;
}

/* Those that lie on each other leave ink once, as links do. */
static void add_run(struct hand *h, const struct stroke *run, uint32_t count, GArray *corner)
{
	float alpha = opacity_of(h, vector_run_alpha(run, count));
	uint16_t leaf = h->f->scene->lines->line[run[0].point].leaf;
	union look look = { .segment = leaf,
		.shade = (uint8_t)CLAMP(alpha * SHADES + 0.5f, 0, SHADES) };
	if (!look.shade)
		return;
	if (h->to->blend != VECTOR_MULTIPLY)
		memcpy(look.rgb, h->from->ink.ink, 3);
	struct vector_path *p = path_of(h, &look);
	vector_run_outline(run, count, h->f->px, corner);
	for (guint n = 0; n < corner->len; n++) {
		const float *px = (const float *)(void *)corner->data + (size_t)2 * n;
		float mm[2] = { px[0] * h->mm_per_px, px[1] * h->mm_per_px };
		g_array_append_val(p->corner, mm);
	}
	g_array_append_val(p->end, p->corner->len);
	h->to->shown += count;
}

static void add_runs(struct hand *h, const struct stroke_blocks *strokes)
{
	g_autofree struct stroke *all = all_of(strokes);
	g_autoptr(GArray) corner = g_array_new(FALSE, FALSE, sizeof(float[2]));
	for (uint32_t n = 0, count; n < strokes->count; n += count) {
		count = vector_run_length(all, n, strokes->count);
		add_run(h, all + n, count, corner);
	}
}

static void fill_layer(struct hand *h, const struct stroke_blocks *strokes)
{
	h->groups = g_hash_table_new(NULL, NULL);
	h->paths = g_hash_table_new_full(look_hash, look_equal, g_free, NULL);
	if (h->from->is_profile)
		add_runs(h, strokes);
	for (uint32_t coat = 0; coat < (h->from->paint ? VECTOR_COATS : 1); coat++)
		if (!h->from->is_profile)
			add_strokes(h, strokes, coat);
	g_ptr_array_sort(h->to->groups, compare_groups);
	h->to->strokes = strokes->count;
	h->to->name = name_of(h);
	g_hash_table_unref(h->paths);
	g_hash_table_unref(h->groups);
}

/* Tones; lines, of which each one tells something, all stay. */
static bool is_thinned(const struct frame_layer *l)
{
	return l->texture && l->hatch;
}

/* How hatching that is too dense is thinned out. */
struct thinning {
	float coarser; /* edges of shapes may lie so much farther from where they should, where many lie on each other */
	float part; /* of the strokes that have shapes then */
};

/* Those that stay have the ink of the others too: half of it by their breadth, half by their strength. Broader alone they would be
 * coarse, stronger alone harsh. */
static void thin_out(struct hand *h, const struct thinning *t)
{
	if (!is_thinned(h->from))
		return;
	h->part = t->part;
	h->layers = sqrtf(1 / h->part);
	h->broader *= h->layers;
	h->shaper.edge_px *= t->coarser * h->layers;
}

/* From a stroke in so many. */
#define SAMPLE 32

static double corners_of(const struct hand *h, const struct stroke_blocks *strokes)
{
	struct vector_shape part[VECTOR_PARTS_MOST];
	union look look;
	double corners = 0;
	uint32_t number = 0;
	for (uint32_t k = 0; k < strokes->blocks; k++)
		for (uint32_t n = 0; n < strokes->block[k]->count; n++) {
			struct stroke s = stroke_unpack(&strokes->block[k]->stroke[n]);
			if (number++ % SAMPLE || !look_of(h, &s, &look))
				continue;
			uint32_t parts = vector_shapes_of(&h->shaper, &s, part);
			for (uint32_t i = 0; i < parts; i++)
				corners += SAMPLE * part[i].corners;
		}
	return corners;
}

/* Where pictures have no gaps between strokes of paint, these are so much broader on a page. */
#define CLOSED_BROADER 1.35f

static struct hand hand_of(const vector_page *p, const frame *f, const struct draw_chosen *chosen,
	const struct frame_layer *from)
{
	const struct camera *c = &f->camera;
	bool is_closed = from->paint && from->paint->gap_px;
	struct hand h = { .f = f,
		.from = from,
		.part = 1,
		.broader = is_closed ? CLOSED_BROADER : 1,
		.layers = 1 };
	h.shaper = vector_shaper_of(from, from->stipple ? NULL : chosen->mask, c->width, c->height,
		FINE_MM * (float)(c->width / p->width_mm));
	h.to = layer_new(from, h.shaper.form);
	h.mm_per_px = (float)(p->width_mm / c->width);
	return h;
}

static double corners_in_all(
	const vector_page *p, const frame *f, const struct draw_chosen *chosen, float coarser)
{
	double corners = 0;
	for (uint32_t n = 0; n < f->layers; n++) {
		if (!is_thinned(&f->layer[n]))
			continue;
		struct hand h = hand_of(p, f, chosen, &f->layer[n]);
		h.shaper.edge_px *= coarser;
		corners += corners_of(&h, &chosen->of_layer[n]);
		layer_free(h.to);
	}
	return corners;
}

#define COARSER 2.f
static struct thinning thinning_of(const vector_page *p, const frame *f,
	const struct draw_chosen *chosen, uint32_t corners_most)
{
	if (corners_in_all(p, f, chosen, 1) <= corners_most)
		return (struct thinning){ 1, 1 };
	double corners = corners_in_all(p, f, chosen, COARSER);
	return (struct thinning){ COARSER, (float)fmin(corners_most / corners, 1) };
}

static void add_layers(vector_page *p, const frame *f, const struct draw_chosen *chosen,
	const segments *tree, uint32_t corners_most)
{
	const struct camera *c = &f->camera;
	struct thinning thinning = thinning_of(p, f, chosen, corners_most);
	g_autoptr(vector_coats) coats =
		vector_coats_new(c->width, c->height, fmaxf(COAT_CELL * f->px, 0.5f));
	for (uint32_t n = 0; n < f->layers; n++) {
		struct hand h = hand_of(p, f, chosen, &f->layer[n]);
		h.tree = tree;
		h.coats = coats;
		thin_out(&h, &thinning);
		vector_coats_clear(coats);
		fill_layer(&h, &chosen->of_layer[n]);
		g_ptr_array_add(p->layers, h.to);
	}
}

vector_page *vector_page_new(draw_room *room, const frame *f, const segments *tree, double width_mm,
	double height_mm, const char *title, struct draw_times *ret_times)
{
	return vector_page_new_thinned(
		room, f, tree, width_mm, height_mm, title, VECTOR_PAGE_CORNERS, ret_times);
}

vector_page *vector_page_new_thinned(draw_room *room, const frame *f, const segments *tree,
	double width_mm, double height_mm, const char *title, uint32_t corners_most,
	struct draw_times *ret_times)
{
	vector_page *p = g_new0(vector_page, 1);
	struct draw_chosen chosen = draw_choose(room, f, ret_times);
	p->width_mm = width_mm;
	p->height_mm = height_mm;
	p->title = g_strdup(title);
	p->has_paper = true;
	for (int k = 0; k < 3; k++)
		p->paper[k] = f->drawing->whole.paper.colour[k];
	p->layers = g_ptr_array_new_with_free_func(layer_free);
	add_layers(p, f, &chosen, tree, corners_most);
	return p;
}

bool vector_page_wants_ground(const frame *f)
{
	bool wants = f->drawing->whole.paper.grain > 0;
	for (guint p = 0; p < f->drawing->pipelines->len; p++)
		wants |= splat_step(f, (uint8_t)p) || frame_step(f, p, "edl");
	return wants;
}
