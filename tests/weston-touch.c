/* A weston module (weston --modules=PATH) with a seat that has a touch screen and a keyboard, for tests. A test drives it
 * through the unix socket that $PLEINAIR_TOUCH_SOCKET names, one line a thing:
 *
 *   down ID X Y    a finger touches; ID is 0 to 31, X and Y are pixels of the screen
 *   move ID X Y    it moves
 *   up ID          it is lifted
 *   frame          what came since the last frame happened at once
 *   key CODE 1|0   a key, by its number in linux/input-event-codes.h, is pressed or released
 *   later MS       the next stamp is at least MS after the last, however soon the line comes
 *   shot FILE      the screen's next picture, as a PNG
 *
 * and each is answered with "ok" once it is done, or with "error: " and why. Stamps are the monotonic clock's and never run
 * back. "later" makes a double tap that is quick on a machine that is not. */
#include <errno.h>
#include <png.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>
#include <weston.h>

/* Exported by libweston and declared only in its own backend.h. */
struct weston_touch_device *weston_touch_create_touch_device(struct weston_touch *touch,
	const char *syspath, void *backend_data, const struct weston_touch_device_ops *ops);
void weston_seat_init(
	struct weston_seat *seat, struct weston_compositor *compositor, const char *name);
int weston_seat_init_touch(struct weston_seat *seat);
int weston_seat_init_keyboard(struct weston_seat *seat, struct xkb_keymap *keymap);
void notify_touch_normalized(struct weston_touch_device *device, const struct timespec *time,
	int id, double x, double y, const struct weston_point2d_device_normalized *normalized,
	int type);
void notify_touch_frame(struct weston_touch_device *device);
void weston_output_damage(struct weston_output *output);
void notify_key(struct weston_seat *seat, const struct timespec *time, uint32_t key,
	enum wl_keyboard_key_state state, enum weston_key_state_update update);

enum { finger_count = 32 };

struct screen {
	struct weston_compositor *compositor;
	struct weston_seat seat;
	struct weston_touch_device *device;
	int64_t stamp_ns;
	bool touching[finger_count];
};

/* One test that is connected. */
struct client {
	struct screen *screen;
	struct wl_event_source *source;
	int fd;
	size_t used;
	char text[4096];
};

struct shot {
	struct wl_listener frame;
	struct weston_output *output;
	char path[2048];
	int fd;
};

static void say(int fd, const char *answer)
{
	/* A test that has gone away is seen by the next read. */
	(void)!send(fd, answer, strlen(answer), MSG_NOSIGNAL);
}

static struct timespec next_stamp(struct screen *screen)
{
	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	int64_t ns = now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
	if (ns > screen->stamp_ns)
		screen->stamp_ns = ns;
	return (struct timespec){ .tv_sec = screen->stamp_ns / 1000000000,
		.tv_nsec = screen->stamp_ns % 1000000000 };
}

static const char *lift(struct screen *screen, int id)
{
	if (id < 0 || id >= finger_count || !screen->touching[id])
		return "error: no such finger is down\n";
	struct timespec stamp = next_stamp(screen);
	screen->touching[id] = false;
	notify_touch_normalized(screen->device, &stamp, id, 0, 0, NULL, WL_TOUCH_UP);
	return "ok\n";
}

static const char *put(struct screen *screen, int id, double x, double y, int type)
{
	if (id < 0 || id >= finger_count || screen->touching[id] != (type == WL_TOUCH_MOTION))
		return "error: that finger is down already, or is not down\n";
	struct timespec stamp = next_stamp(screen);
	screen->touching[id] = true;
	notify_touch_normalized(screen->device, &stamp, id, x, y, NULL, type);
	return "ok\n";
}

static const char *press(struct screen *screen, unsigned code, int pressed)
{
	struct timespec stamp = next_stamp(screen);
	notify_key(&screen->seat, &stamp, code,
		pressed ? WL_KEYBOARD_KEY_STATE_PRESSED : WL_KEYBOARD_KEY_STATE_RELEASED,
		STATE_UPDATE_AUTOMATIC);
	return "ok\n";
}

/* Pixels come as XRGB in a word, in whatever order the renderer's rows are. */
static bool write_png(struct weston_compositor *compositor, const char *path, uint32_t *pixels,
	int32_t width, int32_t height)
{
	bool upside_down = compositor->capabilities & WESTON_CAP_CAPTURE_YFLIP;
	uint8_t *bytes = (uint8_t *)pixels;
	for (size_t i = 0; i < (size_t)width * height; i++)
		memmove(bytes + 3 * i, bytes + 4 * i, 3);
	png_image image = { .version = PNG_IMAGE_VERSION,
		.width = width,
		.height = height,
		.format = PNG_FORMAT_BGR,
		.flags = PNG_IMAGE_FLAG_FAST };
	return png_image_write_to_file(
		&image, path, 0, bytes, upside_down ? -width * 3 : width * 3, NULL);
}

static const char *save_shot(struct shot *shot)
{
	struct weston_compositor *compositor = shot->output->compositor;
	int32_t width = shot->output->current_mode->width;
	int32_t height = shot->output->current_mode->height;
	uint32_t *pixels = malloc((size_t)width * height * sizeof *pixels);
	const char *answer = "error: the screen cannot be read\n";
	if (pixels && compositor->renderer->read_pixels(
			      shot->output, PIXMAN_x8r8g8b8, pixels, 0, 0, width, height) == 0)
		answer = write_png(compositor, shot->path, pixels, width, height)
				 ? "ok\n"
				 : "error: the picture cannot be written\n";
	free(pixels);
	return answer;
}

static void on_frame(struct wl_listener *listener, void *data)
{
	struct shot *shot = wl_container_of(listener, shot, frame);
	(void)data;
	wl_list_remove(&listener->link);
	say(shot->fd, save_shot(shot));
	close(shot->fd);
	free(shot);
}

/* NULL: the answer comes when the screen has been drawn. */
static const char *begin_shot(struct client *client, const char *path)
{
	struct weston_compositor *compositor = client->screen->compositor;
	struct shot *shot =
		wl_list_empty(&compositor->output_list) ? NULL : calloc(1, sizeof *shot);
	if (!shot || strlen(path) >= sizeof shot->path)
		return free(shot), "error: no screen, or too long a path\n";
	shot->output = wl_container_of(compositor->output_list.next, shot->output, link);
	shot->fd = dup(client->fd);
	shot->frame.notify = on_frame;
	strcpy(shot->path, path);
	wl_signal_add(&shot->output->frame_signal, &shot->frame);
	weston_output_damage(shot->output);
	return NULL;
}

static const char *obey(struct client *client, const char *line)
{
	struct screen *screen = client->screen;
	int id, pressed;
	unsigned code;
	double x, y;
	if (sscanf(line, "down %d %lf %lf", &id, &x, &y) == 3)
		return put(screen, id, x, y, WL_TOUCH_DOWN);
	if (sscanf(line, "move %d %lf %lf", &id, &x, &y) == 3)
		return put(screen, id, x, y, WL_TOUCH_MOTION);
	if (sscanf(line, "up %d", &id) == 1)
		return lift(screen, id);
	if (strcmp(line, "frame") == 0)
		return notify_touch_frame(screen->device), "ok\n";
	if (sscanf(line, "key %u %d", &code, &pressed) == 2)
		return press(screen, code, pressed);
	if (sscanf(line, "later %u", &code) == 1)
		return screen->stamp_ns += code * INT64_C(1000000), "ok\n";
	if (strncmp(line, "shot ", 5) == 0)
		return begin_shot(client, line + 5);
	return "error: not understood\n";
}

static void obey_lines(struct client *client)
{
	char *begin = client->text, *end;
	while ((end = memchr(begin, '\n', client->text + client->used - begin))) {
		*end = '\0';
		const char *answer = obey(client, begin);
		if (answer)
			say(client->fd, answer);
		begin = end + 1;
	}
	client->used = client->text + client->used - begin;
	memmove(client->text, begin, client->used);
}

/* Fingers of a test that died must not lie on the next one's screen. */
static void part(struct client *client)
{
	for (int id = 0; id < finger_count; id++)
		if (client->screen->touching[id])
			lift(client->screen, id);
	notify_touch_frame(client->screen->device);
	wl_event_source_remove(client->source);
	close(client->fd);
	free(client);
}

static int on_readable(int fd, uint32_t mask, void *data)
{
	struct client *client = data;
	ssize_t got = read(fd, client->text + client->used, sizeof client->text - client->used);
	(void)mask;
	if (got <= 0) {
		part(client);
		return 0;
	}
	client->used += got;
	obey_lines(client);
	return 1;
}

static int on_connection(int fd, uint32_t mask, void *data)
{
	struct screen *screen = data;
	struct client *client = calloc(1, sizeof *client);
	(void)mask;
	*client = (struct client){ .screen = screen, .fd = accept4(fd, NULL, NULL, SOCK_CLOEXEC) };
	client->source =
		wl_event_loop_add_fd(wl_display_get_event_loop(screen->compositor->wl_display),
			client->fd, WL_EVENT_READABLE, on_readable, client);
	return 0;
}

static int listen_at(const char *path)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	if (!path || strlen(path) >= sizeof address.sun_path)
		return -1;
	strcpy(address.sun_path, path);
	int fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
	if (bind(fd, (struct sockaddr *)&address, sizeof address) == 0 && listen(fd, 4) == 0)
		return fd;
	weston_log("weston-touch: cannot listen at %s: %s\n", path, strerror(errno));
	close(fd);
	return -1;
}

WL_EXPORT int wet_module_init(struct weston_compositor *compositor, int *argc, char *argv[])
{
	(void)argc;
	(void)argv;
	struct screen *screen = calloc(1, sizeof *screen);
	screen->compositor = compositor;
	weston_seat_init(&screen->seat, compositor, "test");
	weston_seat_init_touch(&screen->seat);
	weston_seat_init_keyboard(&screen->seat, NULL);
	/* Without ops, for those ask for a calibration. */
	screen->device = weston_touch_create_touch_device(
		weston_seat_get_touch(&screen->seat), "/pleinair/touch", NULL, NULL);
	int fd = listen_at(getenv("PLEINAIR_TOUCH_SOCKET"));
	if (fd < 0 || !screen->device)
		return -1;
	wl_event_loop_add_fd(wl_display_get_event_loop(compositor->wl_display), fd,
		WL_EVENT_READABLE, on_connection, screen);
	return 0;
}
