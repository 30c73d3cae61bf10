#include "process/segments.h"
#include "render/large.h"
#include "render/scene-bend.h"
#include "render/scene-pager-private.h"
#include "render/scene-paint.h"
#include "render/scene-planes.h"
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>

/* Vectors read beyond the end of a chunk, at most into the next block, which may be written meanwhile: what they get there is masked, but
 * taken for indices before, and may be any. */
#define POINTS_BEYOND (MODEL_CHUNK_POINTS + 16u)
#define THREADS_MOST  8u
/* Readers give way to all else that the machine does. That alone does not keep them from frames: while one of two cores reads, both of
 * the threads that draw may have to share the other one for a tenth of a second. */
#define NICE 12
/* From one frame to the next while points in view are missing; else such a part of the frame. */
#define MISSING_US   33333
#define READING_PART 0.33
/* Room is made for so many units more than are needed now. */
#define UNITS_SPARE 64u

/* ---- threads ---- */

/* Under the lock. PAGE_AWAY of a node that nobody reads, or none. */
static bool next_wanted(scene_pager *p, uint32_t *ret)
{
	for (; p->next < p->asked->len; p->next++) {
		*ret = g_array_index(p->asked, uint32_t, p->next);
		if (p->page[*ret].state == PAGE_AWAY)
			return true;
	}
	return false;
}

/* Under the lock, which it lets go of meanwhile. */
static void bring(scene_pager *p, scene_loader *l, uint32_t node)
{
	struct page *page = &p->page[node];
	struct scene_chunk *c = &p->chunk[node];
	GError *error = NULL;
	uint64_t bytes;
	page->order = scene_units_order(p->tree->node[node].points);
	page->unit = scene_units_take(p->units, page->order);
	if (page->unit == SCENE_UNITS_NONE) {
		p->is_starved = true;
		p->next = p->asked->len; /* until there is room */
		return;
	}
	page->state = PAGE_COMING;
	p->next++;
	p->coming++;
	uint32_t stamp = ++p->stamp;
	g_mutex_unlock(&p->lock);
	*c = (struct scene_chunk){ .stamp = stamp, .list_ends = &p->list_ends[node] };
	c->first = p->first_unit + page->unit * SCENE_UNIT_POINTS;
	bool good = scene_load(l, &p->source, node, p->scene, c, &p->grey, &bytes, &error);
	g_mutex_lock(&p->lock);
	p->coming--;
	p->bytes_read += bytes;
	p->nodes_read++;
	page->state = good ? PAGE_CAME : PAGE_BROKEN;
	g_array_append_val(p->came, node);
	if (good)
		return;
	scene_units_give(p->units, page->unit, page->order);
	if (p->error)
		g_error_free(error);
	else
		p->error = error;
}

/* Under the lock. */
static bool is_reading(scene_pager *p)
{
	uint32_t node;
	return p->coming || next_wanted(p, &node);
}

/* Under the lock. */
static void tell(scene_pager *p)
{
	if (p->error || !is_reading(p))
		g_cond_broadcast(&p->done);
	if (p->watch)
		p->watch(p->watch_data);
}

static gpointer work(gpointer data)
{
	scene_pager *p = data;
	scene_loader *l = scene_loader_new();
	id_t own = (id_t)gettid();
	setpriority(PRIO_PROCESS, own, getpriority(PRIO_PROCESS, own) + NICE);
	g_mutex_lock(&p->lock);
	while (!p->quit) {
		uint32_t node;
		if (p->coming >= p->active_most || g_atomic_int_get(&p->is_quiet) ||
			!next_wanted(p, &node)) {
			g_cond_wait(&p->work, &p->lock);
			continue;
		}
		bring(p, l, node);
		tell(p);
	}
	g_mutex_unlock(&p->lock);
	scene_loader_free(l);
	return NULL;
}

static void start_threads(scene_pager *p)
{
	p->threads = CLAMP((uint32_t)g_get_num_processors(), 1, THREADS_MOST);
	p->thread = g_new(GThread *, p->threads);
	for (uint32_t n = 0; n < p->threads; n++)
		p->thread[n] = g_thread_new("pager", work, p);
}

/* ---- making ---- */

static void set_levels(scene *s, const scene_pager *p)
{
	const struct model_tones *t = model_in_short(p->source.model).tones;
	uint32_t count[256];
	memcpy(count, t->lightness, sizeof count);
	for (uint32_t n = 0; n <= UINT16_MAX; n++) {
		uint8_t rgba[4];
		scene_grey_colour(&p->grey, (uint16_t)n, 0, NULL, rgba);
		if (rgba[3])
			count[scene_lightness(rgba)] += t->intensity[n];
	}
	scene_set_levels(s, count);
}

/* Where so many points may stand, from there on; *at moves behind them. */
static uint64_t place_top(uint64_t *at, uint32_t count)
{
	if (*at / SCENE_PAGER_WITHIN != (*at + count - 1) / SCENE_PAGER_WITHIN)
		*at = (*at / SCENE_PAGER_WITHIN + 1) * SCENE_PAGER_WITHIN;
	uint64_t ret = *at;
	*at += (count + SCENE_PAGER_ALIGNED - 1) / SCENE_PAGER_ALIGNED * SCENE_PAGER_ALIGNED;
	return ret;
}

/* With room that the last of them leaves to the blocks of units after them. */
static uint64_t points_of_tops(const scene_tree *t)
{
	const uint64_t block = SCENE_UNIT_POINTS << (SCENE_UNIT_ORDERS - 1);
	uint64_t at = 0;
	for (uint32_t n = scene_tree_top(t); n < scene_tree_end(t); n++)
		place_top(&at, t->node[n].points);
	return (at + block - 1) / block * block;
}

static void alloc_points(scene_pager *p, scene *s, uint64_t memory_bytes)
{
	uint64_t tops = points_of_tops(p->tree);
	uint64_t fixed = (tops + POINTS_BEYOND) * SCENE_PAGER_POINT_BYTES;
	uint64_t left =
		memory_bytes > fixed + SCENE_PAGER_LEAST ? memory_bytes - fixed : SCENE_PAGER_LEAST;
	uint64_t most = SCENE_POINTS_MOST - POINTS_BEYOND - tops;
	uint64_t room = MIN(left / SCENE_PAGER_POINT_BYTES, most);
	p->units = scene_units_new((uint32_t)(room / SCENE_UNIT_POINTS));
	p->first_unit = (uint32_t)tops;
	size_t count =
		tops + (size_t)scene_units_count(p->units) * SCENE_UNIT_POINTS + POINTS_BEYOND;
	p->bytes = count * SCENE_PAGER_POINT_BYTES;
	scene_alloc_points(s, count);
	s->id = large_new(count * sizeof *s->id);
	s->bend = g_new0(struct scene_bend_plane, 1);
	s->paint = scene_paint_new();
	s->bend->k = g_malloc(count * sizeof *s->bend->k);
}

static void look_at_spacing(scene_pager *p, uint32_t node)
{
	const struct scene_chunk *c = &p->chunk[node];
	uint64_t sum = 0;
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		sum += p->scene->place[i].spacing;
	p->page[node].apart_m = (float)sum / (float)c->count * p->scene->unit_m;
}

static bool load_tops(scene_pager *p, GError **error)
{
	const scene_tree *t = p->tree;
	uint32_t first = scene_tree_top(t), end = scene_tree_end(t);
	GError *wrong = NULL;
	uint64_t at = 0;
	for (uint32_t n = first; n < end; n++) {
		p->chunk[n].first = (uint32_t)place_top(&at, t->node[n].points);
		p->chunk[n].stamp = ++p->stamp;
		p->chunk[n].list_ends = &p->list_ends[n];
	}
#pragma omp parallel
	{
		scene_loader *l = scene_loader_new();
#pragma omp for schedule(dynamic, 16)
		for (uint32_t n = first; n < end; n++) {
			GError *own = NULL;
			uint64_t bytes;
			if (scene_load(l, &p->source, n, p->scene, &p->chunk[n], &p->grey, &bytes,
				    &own)) {
				look_at_spacing(p, n);
				p->page[n].is_there = true;
				p->page[n].state = PAGE_THERE;
			}
#pragma omp critical
			{
				p->bytes_read += bytes;
				if (own && wrong)
					g_error_free(own);
				else if (own)
					wrong = own;
			}
		}
		scene_loader_free(l);
	}
	if (wrong)
		g_propagate_error(error, wrong);
	return !wrong;
}

static void make_empty(scene_pager *p)
{
	p->source.fd = -1;
	g_rw_lock_init(&p->reading);
	g_mutex_init(&p->lock);
	g_cond_init(&p->work);
	g_cond_init(&p->done);
	p->heap = g_array_new(FALSE, FALSE, sizeof(struct heap_entry));
	p->wants = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	p->asked = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	p->came = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	p->there = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	p->active_most = 1;
}

/* All in view of nobody: what is asked of a scene before its first turn. */
static void show_tops(scene_pager *p)
{
	const scene_tree *t = p->tree;
	scene *s = p->scene;
	s->chunks = p->room = scene_tree_end(t) - scene_tree_top(t);
	s->chunk = g_new(struct scene_chunk, s->chunks + 1);
	memcpy(s->chunk, p->chunk + scene_tree_top(t), s->chunks * sizeof *s->chunk);
	for (uint32_t n = 0; n < s->chunks; n++)
		s->count += s->chunk[n].count;
}

scene *scene_paged(const model *m, const uint8_t *leaf_class, uint64_t memory_bytes, GError **error)
{
	g_autoptr(scene) s = g_new0(scene, 1);
	scene_pager *p = s->pager = g_new0(scene_pager, 1);
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(m, &chunks);
	make_empty(p);
	s->serial = scene_serial();
	p->scene = s;
	p->source.model = m;
	p->source.fd = product_reopen(model_file(m), error);
	p->source.tree = p->tree = p->source.fd >= 0 ? scene_tree_new(m, error) : NULL;
	if (!p->tree)
		return NULL;
	p->leaf_class = g_memdup2(leaf_class, SEGMENTS_MAX + 1);
	p->grey = scene_grey_of(m, p->leaf_class);
	if (!scene_planes_load(m, &p->grey, &s->planes, error))
		return NULL;
	struct model_short in_short = model_in_short(m);
	p->source.chunk = g_memdup2(chunk, chunks * sizeof *chunk);
	p->source.group = g_memdup2(in_short.group, in_short.groups * sizeof *in_short.group);
	p->page = g_new0(struct page, scene_tree_end(p->tree) + 1);
	p->chunk = g_new0(struct scene_chunk, scene_tree_end(p->tree) + 1);
	p->list_ends = g_new0(struct scene_list_ends, scene_tree_end(p->tree) + 1);
	p->seen = g_new0(uint32_t, scene_tree_end(p->tree) - scene_tree_top(p->tree) + 1);
	scene_find_origin(s, chunk, chunks);
	scene_find_spacing(s, m);
	scene_find_densities(s, m);
	set_levels(s, p);
	alloc_points(p, s, memory_bytes);
	if (!load_tops(p, error))
		return NULL;
	show_tops(p);
	start_threads(p);
	return g_steal_pointer(&s);
}

void scene_pager_free(scene_pager *p)
{
	if (!p)
		return;
	g_mutex_lock(&p->lock);
	p->quit = true;
	g_cond_broadcast(&p->work);
	g_mutex_unlock(&p->lock);
	for (uint32_t n = 0; n < p->threads; n++)
		g_thread_join(p->thread[n]);
	g_free(p->thread);
	if (p->source.fd >= 0)
		close(p->source.fd);
	GArray *arrays[] = { p->heap, p->wants, p->asked, p->came, p->there };
	for (size_t n = 0; n < G_N_ELEMENTS(arrays); n++)
		g_array_unref(arrays[n]);
	large_free(p->scene->id);
	g_free((void *)p->source.chunk);
	g_free((void *)p->source.group);
	scene_tree_free(p->tree);
	scene_units_free(p->units);
	g_clear_error(&p->error);
	g_free(p->leaf_class);
	g_free(p->page);
	g_free(p->seen);
	g_free(p->chunk);
	g_free(p->list_ends);
	g_rw_lock_clear(&p->reading);
	g_mutex_clear(&p->lock);
	g_cond_clear(&p->work);
	g_cond_clear(&p->done);
	g_free(p);
}

uint32_t scene_pager_points(const scene_pager *p)
{
	return p->first_unit + scene_units_count(p->units) * SCENE_UNIT_POINTS;
}

size_t scene_pager_bytes(const scene_pager *p)
{
	return p->bytes;
}

void scene_pager_boxes(const scene_pager *p,
	void (*visit)(
		uint32_t leaf, const float centre_m[3], const float half_m[3], gpointer user_data),
	gpointer user_data)
{
	for (uint32_t n = 0; n < p->tree->first[1]; n++) {
		const struct scene_node *node = &p->tree->node[n];
		float centre_m[3];
		for (int k = 0; k < 3; k++)
			centre_m[k] = (float)(node->centre_m[k] - p->scene->origin_m[k]);
		visit(node->leaf, centre_m, node->half_m, user_data);
	}
}

static int compare_chunks(const void *a, const void *b)
{
	const struct model_chunk *key = a, *c = b;
	return key->first < c->first ? -1 : key->first >= c->first + c->points;
}

/* Of more points than ids can tell apart, it is one of those that share the id. */
struct scene_owner scene_pager_owner_of(const scene_pager *p, uint32_t id)
{
	const struct model_chunk key = { .first = id };
	const struct model_chunk *c =
		bsearch(&key, p->source.chunk, p->tree->first[1], sizeof key, compare_chunks);
	return c ? (struct scene_owner){ (uint32_t)c->first, (uint32_t)(c->first + c->points),
		c->leaf }
		 : (struct scene_owner){ 0 };
}

/* ---- between turns ---- */

/* Under the lock. */
static void take_what_came(scene_pager *p)
{
	for (guint n = 0; n < p->came->len; n++) {
		uint32_t node = g_array_index(p->came, uint32_t, n);
		struct page *page = &p->page[node];
		if (page->state == PAGE_BROKEN) {
			page->is_broken = true;
			continue;
		}
		page->state = PAGE_THERE;
		page->is_there = true;
		look_at_spacing(p, node);
		g_array_append_val(p->there, node);
	}
	g_array_set_size(p->came, 0);
}

struct idle {
	uint32_t wanted, place; /* in there */
};

static int by_wanted(const void *a, const void *b)
{
	const struct idle *x = a, *y = b;
	return x->wanted != y->wanted ? (x->wanted < y->wanted ? -1 : 1)
				      : (x->place > y->place) - (x->place < y->place);
}

static void forget_page(scene_pager *p, uint32_t place)
{
	uint32_t *node = &g_array_index(p->there, uint32_t, place);
	struct page *page = &p->page[*node];
	scene_units_give(p->units, page->unit, page->order);
	page->state = PAGE_AWAY;
	page->is_there = false;
	*node = UINT32_MAX;
}

/* Under the lock: what was not wanted for longest goes. */
static void make_room(scene_pager *p, uint32_t units)
{
	if (scene_units_left(p->units) >= units)
		return;
	g_autofree struct idle *idle = g_new(struct idle, p->there->len + 1);
	uint32_t count = 0, kept = 0;
	for (guint n = 0; n < p->there->len; n++) {
		uint32_t wanted = p->page[g_array_index(p->there, uint32_t, n)].wanted;
		if (wanted != p->turn)
			idle[count++] = (struct idle){ wanted, n };
	}
	qsort(idle, count, sizeof *idle, by_wanted);
	for (uint32_t n = 0; n < count && scene_units_left(p->units) < units; n++)
		forget_page(p, idle[n].place);
	for (guint n = 0; n < p->there->len; n++) {
		uint32_t node = g_array_index(p->there, uint32_t, n);
		if (node != UINT32_MAX)
			g_array_index(p->there, uint32_t, kept++) = node;
	}
	g_array_set_size(p->there, kept);
}

/* Under the lock. */
static void forget_all(scene_pager *p)
{
	for (guint n = 0; n < p->there->len; n++)
		forget_page(p, n);
	g_array_set_size(p->there, 0);
	p->forgets = false;
}

static uint32_t units_asked(const scene_pager *p)
{
	uint32_t sum = 0;
	for (guint n = 0; n < p->asked->len; n++) {
		uint32_t node = g_array_index(p->asked, uint32_t, n);
		if (p->page[node].state == PAGE_AWAY)
			sum += 1u << scene_units_order(p->tree->node[node].points);
	}
	return sum;
}

/* Under the lock. Blocks that are too small to be of use become whole when all goes that may. */
static void ask(scene_pager *p, const struct scene_look *look)
{
	g_array_set_size(p->asked, 0);
	if (p->wants->len)
		g_array_append_vals(p->asked, p->wants->data, p->wants->len);
	p->next = 0;
	uint32_t units = units_asked(p);
	if (units)
		make_room(p, p->is_starved ? UINT32_MAX : units + UNITS_SPARE);
	p->is_starved = false;
	p->active_most = look->is_moving && !look->is_quiet ? MAX(p->threads / 2, 1) : p->threads;
	g_cond_broadcast(&p->work);
}

/* Threads that give way hold it for a moment, but that is as long as it takes until they may go on. The next turn does what this one
 * cannot. */
static bool get_lock(scene_pager *p, bool is_moving)
{
	if (is_moving)
		return g_mutex_trylock(&p->lock);
	g_mutex_lock(&p->lock);
	return true;
}

void scene_pager_turn(scene_pager *p, const struct scene_look *look, struct scene_turned *ret)
{
	struct scene_turned turned;
	p->began_us = g_get_monotonic_time();
	g_atomic_int_set(&p->is_quiet, look->is_quiet);
	g_rw_lock_writer_lock(&p->reading);
	if (get_lock(p, look->is_moving)) {
		take_what_came(p);
		if (p->forgets)
			forget_all(p);
		g_mutex_unlock(&p->lock);
	}
	scene_refine(p, look, &turned);
	scene_paint_follow(p->scene);
	g_rw_lock_writer_unlock(&p->reading);
	scene_refine_ahead(p, look);
	if (get_lock(p, look->is_moving)) {
		ask(p, look);
		g_mutex_unlock(&p->lock);
	}
	p->missed = turned.missing;
	if (ret)
		*ret = turned;
}

void scene_pager_let_read(scene_pager *p)
{
	gint64 now_us = g_get_monotonic_time();
	gint64 until_us = now_us + (gint64)(READING_PART * (double)(now_us - p->began_us));
	if (!g_atomic_int_get(&p->is_quiet))
		return;
	if (p->missed)
		until_us = MAX(until_us, p->began_us + MISSING_US);
	until_us = MIN(until_us, now_us + MISSING_US);
	g_mutex_lock(&p->lock);
	g_atomic_int_set(&p->is_quiet, false);
	g_cond_broadcast(&p->work);
	while (is_reading(p))
		if (!g_cond_wait_until(&p->done, &p->lock, until_us))
			break;
	g_mutex_unlock(&p->lock);
}

/* Until all that was asked for is there, or cannot be; *ret_starved: there was no room for it. */
static GError *wait_for_all(scene_pager *p, bool *ret_starved)
{
	GError *error = NULL;
	g_mutex_lock(&p->lock);
	while (!p->error && is_reading(p))
		g_cond_wait(&p->done, &p->lock);
	error = g_steal_pointer(&p->error);
	*ret_starved = p->is_starved;
	g_mutex_unlock(&p->lock);
	return error;
}

/* Small nodes may stand so that there is room enough, but in no piece: then it begins anew, where whatever comes fits as long as nothing
 * goes. */
bool scene_pager_settle(scene_pager *p, const struct scene_look *look, GError **error)
{
	struct scene_look still = *look;
	struct scene_turned turned;
	uint32_t starved = 0;
	still.is_moving = false;
	for (;;) {
		bool is_starved;
		scene_pager_turn(p, &still, &turned);
		if (!turned.missing)
			return true;
		GError *wrong = wait_for_all(p, &is_starved);
		if (wrong) {
			g_propagate_error(error, wrong);
			return false;
		}
		starved += is_starved;
		p->forgets = is_starved && starved == 2;
		if (starved > 4) /* what is there must do */
			return true;
	}
}

bool scene_pager_settle_for(const scene *s, const struct camera *c, float ink_px, GError **error)
{
	struct scene_look look = { .camera = c, .ink_px = ink_px };
	return !s->pager || scene_pager_settle(s->pager, &look, error);
}

void scene_pager_watch(scene_pager *p, void (*came)(gpointer user_data), gpointer user_data)
{
	g_mutex_lock(&p->lock);
	p->watch = came;
	p->watch_data = user_data;
	g_mutex_unlock(&p->lock);
}

GError *scene_pager_error(scene_pager *p)
{
	g_mutex_lock(&p->lock);
	GError *error = g_steal_pointer(&p->error);
	g_mutex_unlock(&p->lock);
	return error;
}

void scene_pager_hold(const scene *s)
{
	if (s->pager)
		g_rw_lock_reader_lock(&s->pager->reading);
}

void scene_pager_release(const scene *s)
{
	if (s->pager)
		g_rw_lock_reader_unlock(&s->pager->reading);
}

struct scene_pager_sums scene_pager_sums(scene_pager *p)
{
	g_mutex_lock(&p->lock);
	uint32_t units = scene_units_count(p->units);
	struct scene_pager_sums sums = { .bytes_read = p->bytes_read,
		.nodes_read = p->nodes_read,
		.units = units - scene_units_left(p->units),
		.units_most = units };
	g_mutex_unlock(&p->lock);
	return sums;
}
