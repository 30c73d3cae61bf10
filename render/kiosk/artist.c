#include "render/kiosk/artist.h"
#include "render/kiosk/artist-size.h"
#include "render/kiosk/light-sum.h"
#include "render/scene-pager.h"
#include <gio/gio.h>
#include <math.h>

enum task { TASK_WAIT, TASK_QUIT, TASK_LOOK, TASK_MORE, TASK_FINER, TASK_SMALL, TASK_SWAY };
/* From one picture of what sways to the next, at least. */
#define SWAY_US 40000
/* From one picture of a still view that points still come to, to the next. */
#define MORE_US 250000

/* What the thread hands over. Lives until the last of both sides lets go of it. */
struct post {
	gatomicrefcount users;
	GMainContext *context;
	struct artist_watcher watcher;
	bool closed; /* of the watcher's thread alone */
};

struct artist {
	const scene *scene;
	enum backend_wish backend;
	struct post *post;
	GThread *thread;
	GMutex lock;
	GCond changed;
	int stop; /* atomic, see frame.h */

	/* Under the lock. */
	bool quit, moving;
	bool may_be_stopped; /* what is drawn now: pictures of a moving view are finished, or none would ever be */
	struct camera camera;
	uint32_t serial;       /* of the wish */
	int64_t wished_us;     /* likewise */
	drawing *next_drawing; /* NULL: the one there is */
	bool has_next_accents;
	struct style_light next_light;
	struct style_focus next_focus;
	bool more_came; /* points that were missing */
	bool has_next_small;
	GPtrArray *next_small;
	uint32_t next_small_width, next_small_height;
	char *why;

	/* Of the thread. */
	painter *painter;
	drawing *drawing;
	frame *frame[ARTIST_SIZES];
	bool has_accents;
	struct style_light light;
	struct style_focus focus;
	struct camera seen;
	uint32_t seen_serial;
	int64_t seen_wished_us;
	bool seen_moving, is_broken;
	bool sways;
	int64_t begin_us, swayed_us; /* when time was 0; when the last picture was begun */
	uint32_t size;
	bool is_missing_some; /* in the last still picture */
	gint64 more_us;       /* when it was begun */
	struct light_sum sum;
	GPtrArray *small;
	uint32_t small_width, small_height, small_next;
};

/* ---- post ---- */

static void post_let_go(struct post *p)
{
	if (!g_atomic_ref_count_dec(&p->users))
		return;
	g_main_context_unref(p->context);
	g_free(p);
}

enum letter_kind { LETTER_PICTURE, LETTER_SMALL, LETTER_FAILED };
struct letter {
	struct post *post;
	enum letter_kind kind;
	uint32_t n;
	struct artist_picture picture;
	char *sentence;
};

static void letter_free(gpointer data)
{
	struct letter *l = data;
	g_clear_pointer(&l->picture.bgrx, g_bytes_unref);
	g_free(l->sentence);
	post_let_go(l->post);
	g_free(l);
}

static gboolean open_letter(gpointer data)
{
	struct letter *l = data;
	const struct artist_watcher *w = &l->post->watcher;
	if (l->post->closed)
		return G_SOURCE_REMOVE;
	if (l->kind == LETTER_PICTURE)
		w->picture(&l->picture, w->user_data);
	if (l->kind == LETTER_SMALL && w->small)
		w->small(l->n, &l->picture, w->user_data);
	if (l->kind == LETTER_FAILED && w->failed)
		w->failed(l->sentence, w->user_data);
	return G_SOURCE_REMOVE;
}

static void send(artist *a, struct letter letter)
{
	struct letter *l = g_memdup2(&letter, sizeof letter);
	l->post = a->post;
	g_atomic_ref_count_inc(&a->post->users);
	GSource *source = g_idle_source_new();
	g_source_set_priority(source, G_PRIORITY_DEFAULT);
	g_source_set_callback(source, open_letter, l, letter_free);
	g_source_attach(source, a->post->context);
	g_source_unref(source);
}

static void send_failure(artist *a, const GError *error)
{
	if (!g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED))
		send(a, (struct letter){
				.kind = LETTER_FAILED, .sentence = g_strdup(error->message) });
}

/* ---- drawing, on the thread ---- */

static void forget_frames(artist *a)
{
	for (int n = 0; n < ARTIST_SIZES; n++)
		g_clear_pointer(&a->frame[n], frame_free);
}

static void light_frame(const artist *a, frame *f)
{
	if (!a->has_accents || !f)
		return;
	frame_set_light(f, &a->light);
	frame_set_focus(f, &a->focus);
}

/* Strokes of a picture that is smaller than it is shown may be between as fine on the screen as those of a whole one (0), which there are
 * most of, and as many of its own pixels (1), which hide small things: 320 pixels for 1280 have strokes 3.2 times as large. */
#define COARSER 0.85
static double coarser_of(uint32_t size)
{
	return pow(artist_sizes[size], -COARSER);
}

static frame *find_frame(artist *a, uint32_t size, const struct camera *c, GError **error)
{
	frame **f = &a->frame[size];
	if (*f && ((*f)->camera.width != c->width || (*f)->camera.height != c->height ||
			  (*f)->camera.is_cut != c->is_cut))
		g_clear_pointer(f, frame_free);
	if (!*f) {
		*f = frame_new_coarse(a->scene, a->drawing, c, coarser_of(size), error);
		light_frame(a, *f);
		if (*f)
			(*f)->stop = &a->stop;
		return *f;
	}
	return frame_move(*f, c, error) ? *f : NULL;
}

static frame *frame_of_size(artist *a, uint32_t size, const struct camera *c, GError **error)
{
	frame *f = find_frame(a, size, c, error);
	if (f && a->sways)
		f->time_s = (double)(g_get_monotonic_time() - a->begin_us) * 1e-6;
	return f;
}

/* What is there of the points for a frame, and what to bring for the next ones. false: some are missing. */
static bool turn_scene(artist *a, const frame *f, bool is_moving)
{
	struct scene_pager *pager = a->scene->pager;
	struct scene_look look = { .camera = &f->camera,
		.ink_px = f->ink_px,
		.is_moving = is_moving,
		.is_quiet = is_moving && painter_takes_processor(a->painter) };
	struct scene_turned turned;
	if (!pager)
		return true;
	scene_pager_turn(pager, &look, &turned);
	g_autoptr(GError) wrong = scene_pager_error(pager);
	if (wrong)
		send_failure(a, wrong);
	return !turned.missing;
}

static bool draw(artist *a, uint32_t size, const struct camera *c, bool is_moving,
	struct picture_buffer *ret, GError **error)
{
	frame *f = frame_of_size(a, size, c, error);
	if (!f)
		return false;
	a->is_missing_some = !turn_scene(a, f, is_moving);
	*ret = picture_buffer_new(c->width, c->height);
	if (painter_draw(a->painter, f, ret, NULL, error))
		return true;
	picture_buffer_clear(ret);
	return false;
}

static struct artist_picture to_show(const struct picture_buffer *p, const struct camera *c)
{
	size_t n = (size_t)p->width * p->height;
	uint8_t(*bgrx)[4] = g_malloc_n(n, 4);
	for (size_t i = 0; i < n; i++) {
		bgrx[i][0] = p->rgba[i][2];
		bgrx[i][1] = p->rgba[i][1];
		bgrx[i][2] = p->rgba[i][0];
		bgrx[i][3] = 255;
	}
	return (struct artist_picture){ .bgrx = g_bytes_new_take(bgrx, 4 * n),
		.width = p->width,
		.height = p->height,
		.camera = *c };
}

/* pictures: of artist_picture. */
static bool draw_in_time(artist *a, uint32_t pictures, GError **error)
{
	struct picture_buffer p;
	struct camera c = camera_scaled(&a->seen, artist_sizes[a->size]);
	int64_t begin_us = g_get_monotonic_time();
	if (!draw(a, a->size, &c, true, &p, error))
		return false;
	struct artist_picture show = to_show(&p, &a->seen);
	show.seconds = (double)(g_get_monotonic_time() - begin_us) * 1e-6;
	show.wished_us = pictures ? begin_us : a->seen_wished_us;
	show.pictures = pictures;
	a->swayed_us = begin_us;
	a->size = artist_size_next(a->size, show.seconds);
	send(a, (struct letter){ .kind = LETTER_PICTURE, .picture = show });
	picture_buffer_clear(&p);
	return true;
}

static void show_sum(artist *a, double seconds)
{
	size_t n = (size_t)a->sum.width * a->sum.height;
	uint8_t(*bgrx)[4] = g_malloc_n(n, 4);
	light_sum_mean(&a->sum, bgrx);
	send(a, (struct letter){ .kind = LETTER_PICTURE,
			.picture = { .bgrx = g_bytes_new_take(bgrx, 4 * n),
				.width = a->sum.width,
				.height = a->sum.height,
				.camera = a->seen,
				.pictures = a->sum.pictures,
				.seconds = seconds,
				.wished_us = a->seen_wished_us } });
}

/* One picture more of a still view; shown when the mean has become visibly finer. */
static bool draw_still(artist *a, GError **error)
{
	struct picture_buffer p;
	double shift_px[2];
	light_sum_shift(a->sum.pictures, shift_px);
	struct camera c = camera_shifted(&a->seen, shift_px[0], shift_px[1]);
	int64_t begin_us = g_get_monotonic_time();
	a->more_us = begin_us;
	if (!draw(a, 0, &c, false, &p, error))
		return false;
	light_sum_add(&a->sum, &p);
	picture_buffer_clear(&p);
	if (!(a->sum.pictures & (a->sum.pictures - 1)))
		show_sum(a, (double)(g_get_monotonic_time() - begin_us) * 1e-6);
	return true;
}

static bool draw_small(artist *a, GError **error)
{
	uint32_t n = a->small_next;
	const drawing *d = g_ptr_array_index(a->small, n);
	double factor = fmin(
		(double)a->small_width / a->seen.width, (double)a->small_height / a->seen.height);
	/* Twice as large, then means: thin lines stay calm. */
	struct camera c = camera_scaled(&a->seen, factor);
	c.width = MAX(c.width, 1) * 2;
	c.height = MAX(c.height, 1) * 2;
	c.focal_px *= 2;
	g_autoptr(frame) f = frame_new(a->scene, d, &c, error);
	if (!f)
		return false;
	f->stop = &a->stop;
	turn_scene(a, f, true);
	struct picture_buffer p = picture_buffer_new(c.width, c.height);
	bool good = painter_draw(a->painter, f, &p, NULL, error);
	if (good) {
		struct picture_buffer half = picture_buffer_reduced(&p, 2);
		send(a, (struct letter){ .kind = LETTER_SMALL,
				.n = n,
				.picture = to_show(&half, &a->seen) });
		picture_buffer_clear(&half);
		a->small_next++;
	}
	picture_buffer_clear(&p);
	return good;
}

/* ---- the thread ---- */

static void adopt(artist *a)
{
	if (a->next_drawing) {
		forget_frames(a);
		drawing_free(a->drawing);
		a->drawing = g_steal_pointer(&a->next_drawing);
		a->size = ARTIST_SIZE_FIRST;
		a->has_accents = false;
		a->sways = drawing_sways(a->drawing);
		a->begin_us = g_get_monotonic_time();
	}
	if (a->has_next_accents) {
		a->has_accents = true;
		a->light = a->next_light;
		a->focus = a->next_focus;
		a->has_next_accents = false;
		for (int n = 0; n < ARTIST_SIZES; n++)
			light_frame(a, a->frame[n]);
	}
	if (a->has_next_small) {
		g_clear_pointer(&a->small, g_ptr_array_unref);
		a->small = g_steal_pointer(&a->next_small);
		a->small_width = a->next_small_width;
		a->small_height = a->next_small_height;
		a->has_next_small = false;
		a->small_next = 0;
	}
	if (a->seen_serial == a->serial)
		return;
	a->seen_serial = a->serial;
	a->seen = a->camera;
	a->seen_moving = a->moving;
	a->seen_wished_us = a->wished_us;
	a->is_broken = false;
	a->small_next = 0;
	a->sum.pictures = 0;
}

/* Under the lock. */
static enum task next_task(artist *a)
{
	bool is_new = a->seen_serial != a->serial;
	adopt(a);
	if (!a->drawing || !a->seen.width || a->is_broken)
		return TASK_WAIT;
	if (is_new)
		return TASK_LOOK;
	if (a->seen_moving)
		return TASK_WAIT;
	if (a->is_missing_some && !a->sways)
		return a->more_came ? TASK_MORE : TASK_WAIT;
	if (a->sum.pictures < ARTIST_PICTURES && !a->sways)
		return TASK_FINER;
	if (a->small && a->small_next < a->small->len)
		return TASK_SMALL;
	return a->sways ? TASK_SWAY : TASK_WAIT;
}

static enum task wait_for_task(artist *a)
{
	enum task t = TASK_WAIT;
	g_mutex_lock(&a->lock);
	while (!a->quit) {
		t = next_task(a);
		/* Something else may be wished for until it is time. */
		if (t == TASK_SWAY && g_get_monotonic_time() < a->swayed_us + SWAY_US)
			g_cond_wait_until(&a->changed, &a->lock, a->swayed_us + SWAY_US);
		else if (t == TASK_MORE && g_get_monotonic_time() < a->more_us + MORE_US)
			g_cond_wait_until(&a->changed, &a->lock, a->more_us + MORE_US);
		else if (t == TASK_WAIT)
			g_cond_wait(&a->changed, &a->lock);
		else
			break;
	}
	g_atomic_int_set(&a->stop, 0);
	a->more_came = false;
	a->may_be_stopped = !(t == TASK_LOOK && a->seen_moving);
	if (a->quit)
		t = TASK_QUIT;
	g_mutex_unlock(&a->lock);
	return t;
}

static bool run_task(artist *a, enum task t, GError **error)
{
	if (t == TASK_SMALL)
		return draw_small(a, error);
	if (t == TASK_LOOK && a->seen_moving)
		return draw_in_time(a, 0, error);
	if (t == TASK_SWAY)
		return draw_in_time(a, 1, error);
	if (t == TASK_LOOK || t == TASK_MORE)
		light_sum_restart(&a->sum, a->seen.width, a->seen.height);
	return draw_still(a, error);
}

static bool set_up(artist *a, GError **error)
{
	a->painter = painter_new(a->backend, error);
	if (!a->painter)
		return false;
	g_mutex_lock(&a->lock);
	a->why = g_strdup(painter_why(a->painter));
	g_mutex_unlock(&a->lock);
	return true;
}

static gpointer work(gpointer data)
{
	artist *a = data;
	enum task t;
	g_autoptr(GError) none = NULL;
	bool ready = set_up(a, &none);
	if (!ready)
		send_failure(a, none);
	while ((t = wait_for_task(a)) != TASK_QUIT) {
		g_autoptr(GError) error = NULL;
		bool good = ready && run_task(a, t, &error);
		if (a->scene->pager)
			scene_pager_let_read(a->scene->pager);
		if (good)
			continue;
		/* What cannot be drawn is not tried again before something changes. */
		a->is_broken = !ready || !g_error_matches(error, G_IO_ERROR, G_IO_ERROR_CANCELLED);
		if (error)
			send_failure(a, error);
	}
	forget_frames(a);
	g_clear_pointer(&a->painter, painter_free);
	return NULL;
}

/* ---- from outside ---- */

/* On a thread of the pager. */
static void points_came(gpointer data)
{
	artist *a = data;
	g_mutex_lock(&a->lock);
	a->more_came = true;
	g_cond_signal(&a->changed);
	g_mutex_unlock(&a->lock);
}

artist *artist_new(const scene *s, enum backend_wish wish, const struct artist_watcher *watcher)
{
	artist *a = g_new0(artist, 1);
	a->scene = s;
	a->backend = wish;
	a->size = ARTIST_SIZE_FIRST;
	a->post = g_new0(struct post, 1);
	g_atomic_ref_count_init(&a->post->users);
	a->post->context = g_main_context_ref_thread_default();
	a->post->watcher = *watcher;
	g_mutex_init(&a->lock);
	g_cond_init(&a->changed);
	a->thread = g_thread_new("artist", work, a);
	if (s->pager)
		scene_pager_watch(s->pager, points_came, a);
	return a;
}

/* Under the lock. */
static void wish_is_new(artist *a)
{
	a->serial++;
	a->wished_us = g_get_monotonic_time();
	if (a->may_be_stopped)
		g_atomic_int_set(&a->stop, 1);
	g_cond_signal(&a->changed);
}

void artist_free(artist *a)
{
	if (!a)
		return;
	if (a->scene->pager)
		scene_pager_watch(a->scene->pager, NULL, NULL);
	g_mutex_lock(&a->lock);
	a->quit = true;
	g_atomic_int_set(&a->stop, 1);
	g_cond_signal(&a->changed);
	g_mutex_unlock(&a->lock);
	g_thread_join(a->thread);
	a->post->closed = true;
	post_let_go(a->post);
	drawing_free(a->drawing);
	drawing_free(a->next_drawing);
	g_clear_pointer(&a->small, g_ptr_array_unref);
	g_clear_pointer(&a->next_small, g_ptr_array_unref);
	light_sum_clear(&a->sum);
	g_mutex_clear(&a->lock);
	g_cond_clear(&a->changed);
	g_free(a->why);
	g_free(a);
}

void artist_set_drawing(artist *a, drawing *d)
{
	g_mutex_lock(&a->lock);
	drawing_free(a->next_drawing);
	a->next_drawing = d;
	a->has_next_accents = false;
	wish_is_new(a);
	g_mutex_unlock(&a->lock);
}

void artist_set_accents(artist *a, const struct style_light *light, const struct style_focus *focus)
{
	g_mutex_lock(&a->lock);
	a->next_light = *light;
	a->next_focus = *focus;
	a->has_next_accents = true;
	wish_is_new(a);
	g_mutex_unlock(&a->lock);
}

void artist_set_small(artist *a, GPtrArray *drawings, uint32_t width, uint32_t height)
{
	g_mutex_lock(&a->lock);
	g_clear_pointer(&a->next_small, g_ptr_array_unref);
	a->next_small = drawings;
	a->next_small_width = width;
	a->next_small_height = height;
	a->has_next_small = true;
	g_cond_signal(&a->changed);
	g_mutex_unlock(&a->lock);
}

void artist_look(artist *a, const struct camera *c, bool moving)
{
	g_mutex_lock(&a->lock);
	a->camera = *c;
	a->moving = moving;
	wish_is_new(a);
	g_mutex_unlock(&a->lock);
}

const char *artist_why(const artist *a)
{
	return a->why;
}
