#include "sim/head.h"
#include "sim/camera.h"
#include "sim/certificate.h"
#include "sim/chance.h"
#include "sim/head-stage.h"
#include "sim/host.h"
#include "sim/lidar.h"
#include "sim/truth.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>
#include <time.h>

/* The simulation is a row of events. Each device knows when its next one is due; the earliest
 * happens, may push messages into the outbox, and those become events of their own when they arrive
 * at the host. Nothing else moves time. */

#define VIRTUAL_START_NS INT64_C(1000000000000)
#define PATIENCE_NS      INT64_C(3600000000000) /* a LINK_WAIT without end is answered after this */
#define INDEX_SLOTS      24
#define BEAMS_AT_ONCE    128 /* of work done ahead, so that no event waits long for it */
#define ROWS_AT_ONCE     2
#define GLANCE_NS        2000000 /* while the mirror sweeps there is soon work to do ahead */
#define DOZE_NS          50000000

struct head {
	sim_options *options;
	const struct sim_head_options *wishes;
	const world *world;
	char *certificate;
	world *own_world; /* NULL when it was lent */
	stage *stage;
	lidar *lidar;
	camera *camera; /* NULL: none */
	outbox *out;
	host *host;
	truth_log *log;    /* NULL: none */
	double camera_rad; /* where the front was when faults of the camera were last looked for */
	int64_t now_ns;
	int64_t origin_ns; /* real time: CLOCK_MONOTONIC when the head began, which its time agrees
			      with */
	int64_t lag_ns;    /* ... and is behind by since, for it was led */
	bool led;          /* by LINK_TIME, whose clock the head's is ahead of; up to led_ns */
	int64_t led_ns, ahead_ns;
	bool powered;
	GError *broken; /* why the host was given up */
	bool sent;
};

static int64_t monotonic_ns(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return now.tv_sec * INT64_C(1000000000) + now.tv_nsec;
}

static int64_t real_time_ns(const struct head *h)
{
	int64_t since_ns = monotonic_ns() - h->lag_ns - h->origin_ns;

	if (h->led)
		return h->led_ns;
	if (h->options->speed == 1)
		return h->origin_ns + since_ns;
	return h->origin_ns + llrint((double)since_ns * h->options->speed);
}

static void tell_truth(const struct sim_truth_revolution *revolution, gpointer user_data)
{
	struct head *h = user_data;

	if (h->log)
		truth_log_write(h->log, revolution);
	if (h->wishes->truth)
		h->wishes->truth(revolution, h->wishes->truth_data);
}

static double from_seed(const sim_options *o, uint64_t what, double low, double high)
{
	return low + (high - low) * chance_uniform(chance_hash(o->seed, CHANCE_STAGE, 0, what));
}

struct stage_desc sim_head_stage(const sim_options *o, int64_t now_ns)
{
	double azimuth_deg = isnan(o->home_deg) ? from_seed(o, 0, 20, 340) : o->home_deg;

	return (struct stage_desc){ .steps_per_turn = o->steps_per_turn,
		.index_slots = INDEX_SLOTS,
		.initial_azimuth_rad = azimuth_deg * M_PI / 180,
		.backlash_steps = o->backlash_steps,
		.clock = { .origin_ns = now_ns,
			.start_ticks = o->stage_clock_start == UINT64_MAX
					       ? (uint64_t)from_seed(o, 1, 0, 4294967296.0)
					       : o->stage_clock_start,
			.tick_ns = 1e3,
			.drift_ppm = isnan(o->stage_ppm) ? from_seed(o, 2, -50, 50) : o->stage_ppm,
			.bits = 32 } };
}

static void make_devices(struct head *h, const struct world_station *station)
{
	bool wants_truth = h->log || h->wishes->truth;
	struct stage_desc turns = sim_head_stage(h->options, h->now_ns);

	h->out = outbox_new();
	h->stage = stage_new(&turns, h->now_ns);
	h->lidar = lidar_new(&(struct lidar_setup){ .options = h->options,
		.world = h->world,
		.station = *station,
		.stage = h->stage,
		.out = h->out,
		.truth = wants_truth ? tell_truth : NULL,
		.truth_data = h,
		.settle_ns = h->wishes->settle_ns,
		.now_ns = h->now_ns });
	h->camera = camera_new(&(struct camera_setup){ .options = h->options,
		.world = h->world,
		.station = *station,
		.stage = h->stage,
		.out = h->out,
		.now_ns = h->now_ns });
}

static bool head_begin(struct head *h, GError **error)
{
	struct world_station station;

	h->options = options_parse(h->wishes->description, error);
	if (!h->options)
		return false;
	if (!(h->certificate = certificate_json(h->options, error)))
		return false;
	h->world = h->wishes->world;
	struct world_variant variant = options_variant(h->options);
	if (!h->world)
		h->world = h->own_world =
			world_new(h->options->scene, h->options->seed, &variant, error);
	if (!h->world || !truth_station_of(h->options, h->world, &station, error))
		return false;
	if (h->options->truth && !(h->log = truth_log_new(h->options->truth, error)))
		return false;
	h->now_ns = h->origin_ns = h->options->speed > 0 ? monotonic_ns() : VIRTUAL_START_NS;
	h->powered = true;
	make_devices(h, &station);
	return true;
}

static void head_end(struct head *h)
{
	lidar_free(h->lidar);
	camera_free(h->camera);
	stage_free(h->stage);
	outbox_free(h->out);
	world_free(h->own_world);
	truth_log_free(h->log);
	options_free(h->options);
	host_free(h->host);
	g_free(h->certificate);
}

static void give_up(struct head *h)
{
	h->powered = false;
}

static void send(
	struct head *h, enum link_kind kind, int64_t host_ns, const void *payload, gsize length)
{
	if (h->powered &&
		!host_send(h->host, kind, host_ns - h->ahead_ns, payload, length, &h->broken))
		give_up(h);
}

static void greet(struct head *h)
{
	g_autoptr(GByteArray) payload = g_byte_array_new();
	struct link_hello hello = { .version = LINK_VERSION, .real_time = h->options->speed > 0 };

	g_strlcpy(hello.lidar_protocol, h->options->lidar->protocol, sizeof hello.lidar_protocol);
	g_byte_array_append(payload, (const guint8 *)&hello, sizeof hello);
	g_byte_array_append(payload, (const guint8 *)h->certificate, (guint)strlen(h->certificate));
	send(h, LINK_HELLO, h->now_ns, payload->data, payload->len);
}

/* Whoever drives the stage by pulses has one of its own, which the same happens to. */
static void slip(struct head *h, double steps)
{
	stage_slip(h->stage, h->now_ns, steps);
	if (h->wishes->settle_ns == 0)
		return;
	GByteArray *payload = g_byte_array_new();

	g_byte_array_append(payload, (const guint8 *)&steps, sizeof steps);
	outbox_push(h->out, h->now_ns, LINK_STAGE_SLIPPED, payload);
}

static void strike(struct head *h, const struct fault *fault)
{
	switch (fault->kind) {
	case FAULT_POWER: give_up(h); break;
	case FAULT_STAGE: stage_fail(h->stage, h->now_ns); break;
	case FAULT_ESTOP: stage_press(h->stage, h->now_ns, fault->param); break;
	case FAULT_INTERLOCK: stage_open(h->stage, h->now_ns, fault->param); break;
	case FAULT_SLIP: slip(h, fault->param); break;
	case FAULT_EPSTALL: outbox_push(h->out, h->now_ns, LINK_LIDAR_HALTED, NULL); break;
	default:
		if (fault_is_of_camera(fault->kind))
			camera_strike(h->camera, h->now_ns, fault);
		else
			lidar_strike(h->lidar, h->now_ns, fault);
	}
}

static void strike_between(struct head *h, double from_rad, double to_rad, bool of_camera)
{
	const double columns_per_rad = FAULT_COLUMNS / (2 * M_PI);
	const struct fault *fault;

	if (!stage_is_homed(h->stage))
		return;
	while ((fault = fault_take(h->options->faults, from_rad * columns_per_rad,
			to_rad * columns_per_rad, of_camera)))
		strike(h, fault);
}

/* Faults of the camera strike as the head turns by, whether it exposes there or not. */
static void pass_camera(struct head *h)
{
	double now_rad = stage_azimuth_rad(h->stage, h->now_ns, 0);

	if (h->camera)
		strike_between(h, h->camera_rad, now_rad, true);
	h->camera_rad = now_rad;
}

static void run_stage(struct head *h)
{
	GByteArray *batch = stage_run(h->stage, h->now_ns);

	pass_camera(h);

	if (batch) {
		uint64_t draw = chance_hash(h->options->seed, CHANCE_STAGE, 1, (uint64_t)h->now_ns);

		outbox_push(h->out, h->now_ns + 30000 + (int64_t)(draw % 100000), LINK_STAGE_EVENTS,
			batch);
	}
}

static void run_lidar(struct head *h)
{
	double from_rad, to_rad;

	if (lidar_passes(h->lidar, &from_rad, &to_rad))
		strike_between(h, from_rad, to_rad, false);
	lidar_run(h->lidar, h->now_ns - h->wishes->settle_ns);
}

static void run_outbox(struct head *h)
{
	struct outbox_message message = outbox_pop(h->out);
	const GByteArray *payload = message.payload;

	send(h, message.kind, message.due_ns, payload ? payload->data : NULL,
		payload ? payload->len : 0);
	outbox_message_clear(&message);
	h->sent = true;
}

static int64_t next_ns(const struct head *h)
{
	int64_t device_ns = MIN(stage_next_ns(h->stage), lidar_next_ns(h->lidar));

	if (h->camera)
		device_ns = MIN(device_ns, camera_next_ns(h->camera));
	return MIN(device_ns, outbox_next_ns(h->out));
}

/* Lets the next thing happen if it is due by then. */
static bool run_next(struct head *h, int64_t until_ns)
{
	int64_t due_ns = next_ns(h);

	if (due_ns > until_ns || !h->powered)
		return false;
	h->now_ns = MAX(h->now_ns, due_ns);
	if (stage_next_ns(h->stage) == due_ns)
		run_stage(h);
	else if (lidar_next_ns(h->lidar) == due_ns)
		run_lidar(h);
	else if (h->camera && camera_next_ns(h->camera) == due_ns)
		camera_run(h->camera, h->now_ns);
	else
		run_outbox(h);
	return true;
}

/* The host sleeps: everything happens up to the first thing that wakes it. */
static void answer_wait(struct head *h, int64_t deadline_ns)
{
	int64_t until_ns = CLAMP(deadline_ns, h->now_ns, h->now_ns + PATIENCE_NS);

	h->sent = false;
	while (!h->sent && run_next(h, until_ns))
		;
	if (!h->sent)
		h->now_ns = until_ns;
	send(h, LINK_NOW, h->now_ns, NULL, 0);
}

static bool obey_pulses(struct head *h, const guint8 *payload, gsize length)
{
	struct link_stage_pulse pulse;

	for (gsize at = 0; at + sizeof pulse <= length; at += sizeof pulse) {
		memcpy(&pulse, payload + at, sizeof pulse);
		stage_pulse(
			h->stage, MIN(pulse.at_ns + h->ahead_ns, real_time_ns(h)), pulse.direction);
	}
	return length % sizeof pulse == 0;
}

static bool obey_time(struct head *h, const guint8 *payload, gsize length)
{
	int64_t told_ns;

	if (length != sizeof told_ns || h->options->speed != 1)
		return false;
	memcpy(&told_ns, payload, sizeof told_ns);
	if (told_ns < 0) {
		h->lag_ns = h->led ? monotonic_ns() - h->led_ns : h->lag_ns;
		h->ahead_ns = 0;
		h->led = false;
		return true;
	}
	if (!h->led) {
		h->led_ns = MAX(real_time_ns(h), h->now_ns);
		h->ahead_ns = h->led_ns - told_ns;
	}
	h->led = true;
	h->led_ns = MAX(h->led_ns, told_ns + h->ahead_ns);
	return true;
}

static bool obey_device(struct head *h, const struct link_header *header, const guint8 *payload)
{
	switch (header->kind) {
	case LINK_LIDAR_OPEN: lidar_open(h->lidar, h->now_ns); return header->length == 0;
	case LINK_LIDAR_CLOSE: lidar_close(h->lidar); return header->length == 0;
	case LINK_LIDAR_WRITE:
		lidar_write(h->lidar, h->now_ns, payload, header->length);
		return true;
	case LINK_STAGE_STOP: stage_halt(h->stage, h->now_ns); return header->length == 0;
	case LINK_STAGE_BEGIN: stage_begin_pulses(h->stage, h->now_ns); return header->length == 0;
	case LINK_TIME: return obey_time(h, payload, header->length);
	case LINK_STAGE_PULSES: return obey_pulses(h, payload, header->length);
	case LINK_STAGE_RESET: stage_unlatch(h->stage); return header->length == 0;
	case LINK_CAMERA_QUEUE:
		if (h->camera)
			camera_lend(h->camera, h->now_ns);
		else
			outbox_push(h->out, h->now_ns, LINK_CAMERA_GONE, NULL);
		return header->length == 0;
	default: return false;
	}
}

static bool obey(struct head *h, const struct link_header *header, const guint8 *payload)
{
	struct link_stage_move move;
	struct link_camera_controls controls;
	struct link_line line;

	switch (header->kind) {
	case LINK_LIDAR_LINE:
		if (header->length != sizeof line)
			return false;
		memcpy(&line, payload, sizeof line);
		lidar_set_line(h->lidar, h->now_ns, &line);
		return true;
	case LINK_WAIT:
		if (h->options->speed > 0 || header->length != 0)
			return false;
		answer_wait(h, header->host_ns);
		return true;
	case LINK_STAGE_MOVE:
		if (header->length != sizeof move)
			return false;
		memcpy(&move, payload, sizeof move);
		return stage_move(h->stage, h->now_ns, &move);
	case LINK_CAMERA_CONTROLS:
		if (header->length != sizeof controls)
			return false;
		memcpy(&controls, payload, sizeof controls);
		return !h->camera || camera_control(h->camera, &controls);
	default: return obey_device(h, header, payload);
	}
}

static void obey_all(struct head *h)
{
	struct link_header header;
	const guint8 *payload;

	while (h->powered && !h->broken && host_next(h->host, &header, &payload, &h->broken))
		if (!obey(h, &header, payload))
			g_set_error(&h->broken, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
				"the host sent a message that makes no sense: kind %u, %u bytes",
				header.kind, header.length);
}

/* Uses a quiet moment to compute what will be due; false if there is nothing to do ahead. */
static bool prepare(struct head *h)
{
	return lidar_prepare(h->lidar, h->now_ns - h->wishes->settle_ns, BEAMS_AT_ONCE) ||
	       (h->camera && camera_prepare(h->camera, h->now_ns, ROWS_AT_ONCE));
}

static int64_t patience_ns(struct head *h)
{
	if (h->options->speed <= 0)
		return -1;
	while (run_next(h, real_time_ns(h)))
		;
	h->now_ns = MAX(h->now_ns, real_time_ns(h));
	if (prepare(h))
		return 0;
	if (h->led)
		return -1;
	double until_ns = (double)(next_ns(h) - h->now_ns) / h->options->speed;
	bool sweeping = lidar_next_ns(h->lidar) != INT64_MAX;

	return (int64_t)CLAMP(until_ns, 0, sweeping ? GLANCE_NS : DOZE_NS);
}

static bool serve(struct head *h)
{
	enum host_state state = HOST_IDLE;

	greet(h);
	while (h->powered && !h->broken && state < HOST_GONE) {
		state = host_listen(h->host, patience_ns(h), &h->broken);
		if (h->options->speed > 0)
			while (run_next(h, real_time_ns(h)))
				;
		obey_all(h);
	}
	return !h->broken;
}

bool sim_head_serve(int fd, const struct sim_head_options *options, GError **error)
{
	struct head h = { .wishes = options, .host = host_new(fd) };
	bool good = head_begin(&h, error);

	if (good && !serve(&h)) {
		g_propagate_error(error, h.broken);
		good = false;
	}
	head_end(&h);
	return good;
}
