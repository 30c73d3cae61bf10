/* A head of real parts: a wire, pins, a camera. It sleeps until one of them has something to say; the host's clock is theirs. */
#include "firmware-io/inbox.h"
#include "firmware-io/parts.h"
#include <errno.h>
#include <poll.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

#define SECOND_NS INT64_C(1000000000)

struct parts_head {
	head base;
	stage no_stage; /* stands in where none is set up */
};

static const struct scheme {
	const char *name, *protocol;
	wire *(*open_usb)(head *h, const parts *p, const char *scheme, GError **error);
	wire *(*open_tty)(head *h, const parts *p, const char *scheme, GError **error);
} schemes[] = {
	{ "tim", "cola", wire_new_usb, NULL },
	{ "scip", "scip", wire_new_usb, wire_new_tty },
	{ "ld", "ld", NULL, wire_new_tty },
	{ "rplidar", "rplidar", NULL, wire_new_tty },
};

/* ---- where no stage is set up: a lidar can still be talked to ---- */

static bool no_move(stage *s, const struct stage_move *move, GError **error)
{
	(void)s;
	(void)move;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"no pan stage is set up: /etc/pleinair.conf says in [stage] on which pins it is");
	return false;
}

static bool no_stop(stage *s, GError **error)
{
	(void)s;
	(void)error;
	return true;
}

static gssize no_events(
	stage *s, const struct stage_event **ret_events, int64_t *ret_arrival_ns, GError **error)
{
	(void)s;
	(void)error;
	*ret_events = NULL;
	*ret_arrival_ns = 0;
	return 0;
}

static const struct stage_ops no_stage_ops = {
	.move = no_move, .stop = no_stop, .read = no_events
};

/* ---- the head ---- */

static int64_t parts_now_ns(head *h)
{
	(void)h;
	return inbox_now_ns();
}

static bool parts_wait(head *h, int64_t deadline_ns, GError **error)
{
	struct pollfd fds[] = {
		{ .fd = h->lidar->ops->wait_fd(h->lidar), .events = POLLIN },
		{ .fd = h->stage->ops->wait_fd ? h->stage->ops->wait_fd(h->stage) : -1,
			.events = POLLIN },
		{ .fd = h->camera ? h->camera->ops->wait_fd(h->camera) : -1, .events = POLLIN },
	};
	int64_t left_ns = deadline_ns - inbox_now_ns();
	left_ns = MAX(left_ns, 0); /* that macro would ask the clock twice */
	struct timespec left = { left_ns / SECOND_NS, left_ns % SECOND_NS };
	/* A signal (Ctrl-C) is the caller's business, at the end of the turn. */
	if (ppoll(fds, G_N_ELEMENTS(fds), &left, NULL) >= 0 || errno == EINTR)
		return true;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN, "the head cannot be waited for: %s",
		g_strerror(errno));
	return false;
}

static void parts_close(head *h)
{
	struct parts_head *ph = (struct parts_head *)h;
	if (h->camera)
		h->camera->ops->close(h->camera);
	if (h->stage && h->stage->ops->close)
		h->stage->ops->close(h->stage);
	if (h->lidar)
		h->lidar->ops->free(h->lidar);
	g_free(ph);
}

static const struct head_ops parts_ops = {
	.now_ns = parts_now_ns, .wait = parts_wait, .close = parts_close
};

/* ---- its certificate ---- */

/* What is known of a head that nobody has calibrated: where its parts are meant to be. */
static bool nominal_certificate(head *h, const parts *p, GError **error)
{
	double steps, slots;
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	if (!parts_number(p, "stage", "steps_per_turn", 16, 1e8, 3200, &steps, error) ||
		!parts_number(p, "stage", "index_slots", 0, 100000, 1, &slots, error))
		return false;
	h->calibration = g_strdup_printf(
		"{\"serial\":\"uncalibrated\",\"lidar\":{\"beam_zero_deg\":90,\"beam_direction\":1,"
		"\"range_offset_m\":0,\"rotation_deg\":[0,0,0],\"translation_m\":[0,0,0]},"
		"\"stage\":{\"steps_per_turn\":%s,\"index_slots\":%u,\"azimuth_zero_deg\":0,"
		"\"clock_hz\":1000000,\"clock_bits\":32},\"camera\":null}",
		g_ascii_dtostr(text, sizeof text, steps), (unsigned)slots);
	return true;
}

static bool read_certificate(head *h, const parts *p, GError **error)
{
	const char *path = parts_text(p, "head", "certificate");
	g_autoptr(GError) failed = NULL;
	if (!path)
		return nominal_certificate(h, p, error);
	if (g_file_get_contents(path, &h->calibration, NULL, &failed))
		return true;
	g_set_error(error, WIRE_ERROR, WIRE_ERROR_BROKEN,
		"the head's certificate cannot be read: %s", failed->message);
	return false;
}

/* ---- opening ---- */

static const struct scheme *find_scheme(const char *uri)
{
	for (size_t i = 0; i < G_N_ELEMENTS(schemes); i++) {
		size_t n = strlen(schemes[i].name);
		if (strncmp(uri, schemes[i].name, n) == 0 && uri[n] == ':')
			return &schemes[i];
	}
	return NULL;
}

/* A path is a serial line's; anything else names a USB port. */
static wire *open_wire(head *h, const parts *p, const struct scheme *s, GError **error)
{
	bool path = g_str_has_prefix(parts_rest(p), "/");
	return !s->open_usb || (path && s->open_tty) ? s->open_tty(h, p, s->name, error)
						     : s->open_usb(h, p, s->name, error);
}

/* NULL without an error: none is set up. */
static bool open_stage_and_camera(struct parts_head *ph, const parts *p, GError **error)
{
	g_autoptr(GError) failed = NULL;
	head *h = &ph->base;
	h->stage = stage_new_pins(h, p, &failed);
	if (!failed)
		h->camera = camera_new_v4l2(h, p, &failed);
	if (failed) {
		g_propagate_error(error, g_steal_pointer(&failed));
		return false;
	}
	ph->no_stage = (stage){ &no_stage_ops, h };
	if (!h->stage)
		h->stage = &ph->no_stage;
	return true;
}

head *head_open_parts(const char *uri, GError **error)
{
	const struct scheme *s = find_scheme(uri);
	g_autoptr(parts) p = parts_read(uri, error);
	if (!p)
		return NULL;
	g_assert(s);
	struct parts_head *ph = g_new0(struct parts_head, 1);
	head *h = &ph->base;
	h->ops = &parts_ops;
	h->lidar_protocol = g_strdup(s->protocol);
	h->lidar = open_wire(h, p, s, error);
	if (h->lidar && read_certificate(h, p, error) && open_stage_and_camera(ph, p, error))
		return h;
	head_close(h);
	return NULL;
}
