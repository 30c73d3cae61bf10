/* The head as a kernel's drivers and the agent in a guest see it (sim/kernel.h), by sockets, without a kernel. */
#include "sim/kernel.h"
#include <arpa/inet.h>
#include <glib/gstdio.h>
#include <math.h>
#include <string.h>
#include <sys/socket.h>
#include <time.h>
#include <unistd.h>

#define SECOND INT64_C(1000000000)
#define STEPS  11886.0
#define READS  64 /* that the host has asked for at once */

struct bench {
	struct kernel_options options;
	int until[2];
	GThread *thread;
	GMutex lock;
	GCond listens;
	uint16_t usb_port, agent_port;

	int usb, agent;
	uint32_t seqnum;
	GArray *writes; /* uint32_t: seqnums */
	GString *text;  /* of the lidar */
	guint halts;
	bool unplugged;
};

static int64_t now_ns(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return now.tv_sec * SECOND + now.tv_nsec;
}

static void on_listens(uint16_t usb_port, uint16_t agent_port, gpointer data)
{
	struct bench *b = data;

	g_mutex_lock(&b->lock);
	b->usb_port = usb_port;
	b->agent_port = agent_port;
	g_cond_signal(&b->listens);
	g_mutex_unlock(&b->lock);
}

static gpointer serve(gpointer data)
{
	struct bench *b = data;
	g_autoptr(GError) error = NULL;

	kernel_serve(&b->options, b->until[0], &error);
	g_assert_no_error(error);
	return NULL;
}

static int reach(uint16_t port)
{
	struct sockaddr_in address = { .sin_family = AF_INET,
		.sin_port = htons(port),
		.sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
	struct timeval patience = { 10, 0 };
	int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);

	g_assert_cmpint(connect(fd, (struct sockaddr *)&address, sizeof address), ==, 0);
	setsockopt(fd, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
	return fd;
}

static bool receive(int fd, void *bytes, gsize length)
{
	return length == 0 || recv(fd, bytes, length, MSG_WAITALL) == (ssize_t)length;
}

static void write32(uint8_t *p, uint32_t value)
{
	for (int i = 0; i < 4; i++)
		p[i] = (uint8_t)(value >> (24 - 8 * i));
}

static uint32_t read32(const uint8_t *p)
{
	return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | p[3];
}

/* False: it is not plugged in. */
static bool import(struct bench *b)
{
	uint8_t request[40] = { 0x01, 0x11, 0x80, 0x03, 0, 0, 0, 0, '1', '-', '1' }, reply[8],
		device[312];

	b->usb = reach(b->usb_port);
	g_assert_cmpint(send(b->usb, request, sizeof request, 0), ==, sizeof request);
	g_assert_true(receive(b->usb, reply, sizeof reply));
	if (read32(reply + 4) == 0)
		return receive(b->usb, device, sizeof device);
	close(b->usb);
	return false;
}

static void submit(
	struct bench *b, uint8_t endpoint, const uint8_t *setup, const char *data, uint32_t length)
{
	uint8_t message[48] = { 0 };

	write32(message, 1);
	write32(message + 4, ++b->seqnum);
	write32(message + 12, endpoint >> 7);
	write32(message + 16, endpoint & 15);
	write32(message + 24, length);
	if (setup)
		memcpy(message + 40, setup, 8);
	send(b->usb, message, sizeof message, MSG_NOSIGNAL);
	if (endpoint & 0x80)
		return;
	send(b->usb, data, length, MSG_NOSIGNAL);
	g_array_append_val(b->writes, b->seqnum);
}

/* Its answer brings no bytes. */
static bool was_write(const struct bench *b, uint32_t seqnum)
{
	for (guint i = 0; i < b->writes->len; i++)
		if (g_array_index(b->writes, uint32_t, i) == seqnum)
			return true;
	return false;
}

static void say(struct bench *b, const char *command)
{
	g_autofree char *frame = g_strdup_printf("\2%s\3", command);

	submit(b, 0x02, NULL, frame, (uint32_t)strlen(frame));
}

static void clear_halt(struct bench *b)
{
	submit(b, 0, (const uint8_t[8]){ 2, 1, 0, 0, 0x81, 0, 0, 0 }, NULL, 0);
	for (int i = 0; i < READS; i++)
		submit(b, 0x81, NULL, NULL, 65536);
}

/* One answer. To a read, there is another read; a halt is cleared once all reads have failed. */
static void take_answer(struct bench *b)
{
	uint8_t head[48];
	static char bytes[65536];

	b->unplugged = !receive(b->usb, head, sizeof head);
	if (b->unplugged)
		return;
	int status = (int)read32(head + 20);
	uint32_t length = read32(head + 24);

	if (status == -32 && ++b->halts % READS == 0)
		clear_halt(b);
	if (status != 0 || was_write(b, read32(head + 4)))
		return;
	g_assert_true(receive(b->usb, bytes, length));
	g_string_append_len(b->text, bytes, length);
	submit(b, 0x81, NULL, NULL, 65536);
}

static void take_answers(struct bench *b)
{
	char byte;

	while (!b->unplugged) {
		ssize_t got = recv(b->usb, &byte, 1, MSG_PEEK | MSG_DONTWAIT);

		if (got < 0)
			return;
		take_answer(b);
	}
}

static void tell(struct bench *b, uint32_t kind, const void *payload, gsize length)
{
	struct link_header header = { (uint32_t)length, kind, 0 };

	g_assert_cmpint(send(b->agent, &header, sizeof header, MSG_NOSIGNAL), ==, sizeof header);
	g_assert_cmpint(send(b->agent, payload, length, MSG_NOSIGNAL), ==, (gssize)length);
}

static struct bench *start(const char *description)
{
	struct bench *b = g_new0(struct bench, 1);
	struct link_header header;
	struct kernel_stage stage;

	b->options = (struct kernel_options){
		.description = description, .listens = on_listens, .data = b
	};
	b->text = g_string_new(NULL);
	b->writes = g_array_new(FALSE, FALSE, sizeof(uint32_t));
	g_assert_cmpint(pipe(b->until), ==, 0);
	g_mutex_lock(&b->lock);
	b->thread = g_thread_new("kernel", serve, b);
	while (!b->usb_port)
		g_cond_wait(&b->listens, &b->lock);
	g_mutex_unlock(&b->lock);
	b->agent = reach(b->agent_port);
	g_assert_true(receive(b->agent, &header, sizeof header));
	g_assert_cmpuint(header.kind, ==, KERNEL_STAGE);
	g_assert_true(receive(b->agent, &stage, sizeof stage));
	g_assert_cmpfloat(stage.steps_per_turn, ==, STEPS);
	g_assert_cmpfloat_with_epsilon(stage.initial_azimuth_rad, 350 * G_PI / 180, 1e-9);
	tell(b, LINK_STAGE_BEGIN, NULL, 0);
	g_assert_true(import(b));
	for (int i = 0; i < READS; i++)
		submit(b, 0x81, NULL, NULL, 65536);
	say(b, "sEN LMDscandata 1");
	return b;
}

static void stop(struct bench *b)
{
	close(b->usb);
	close(b->agent);
	g_assert_cmpint(write(b->until[1], "", 1), ==, 1);
	g_thread_join(b->thread);
	close(b->until[0]);
	close(b->until[1]);
	g_string_free(b->text, TRUE);
	g_array_unref(b->writes);
	g_free(b);
}

struct pulse {
	int64_t at_ns, sent_ns;
};

/* Clockwise, at a pace that goes to and fro between 400 and 600 a second. */
static GArray *turn(struct bench *b, guint count)
{
	GArray *pulses = g_array_new(FALSE, FALSE, sizeof(struct pulse));
	int64_t at_ns = now_ns() + SECOND / 10;

	for (guint i = 0; i < count; i++) {
		at_ns += (int64_t)(1e9 / (500 + 100 * sin(i / 50.0)));
		while (now_ns() < at_ns) {
			take_answers(b);
			g_usleep(500);
		}
		struct pulse pulse = { at_ns, now_ns() };
		struct link_stage_pulse told = { .at_ns = at_ns, .direction = 1 };

		tell(b, LINK_STAGE_PULSES, &told, sizeof told);
		g_array_append_val(pulses, pulse);
	}
	return pulses;
}

/* Where the rotor is between pulses, or -1: not known by the time that it had to be. */
static double steps_at(const GArray *pulses, double time_ns)
{
	for (guint i = 1; i < pulses->len; i++) {
		const struct pulse *p = &g_array_index(pulses, struct pulse, i);

		if (p->sent_ns > time_ns + (KERNEL_SETTLE_MS - 20) * 1e6)
			return -1;
		if ((double)p->at_ns >= time_ns && (double)p[-1].at_ns <= time_ns)
			return i +
			       (time_ns - (double)p[-1].at_ns) / (double)(p->at_ns - p[-1].at_ns);
	}
	return -1;
}

/* Beams that were told of in time; ret_right: those that were cast at the angle that the pulses make. */
static guint check_beams(FILE *file, const GArray *pulses, guint *ret_right)
{
	uint32_t numbers[2];
	int64_t first_ns;
	double period_ns, azimuth[811], range[811];
	guint checked = 0;

	while (fread(numbers, sizeof numbers, 1, file) == 1 && fread(&first_ns, 8, 1, file) == 1 &&
		fread(&period_ns, 8, 1, file) == 1 &&
		fread(azimuth, 8, numbers[1], file) == numbers[1] &&
		fread(range, 8, numbers[1], file) == numbers[1])
		for (uint32_t i = 0; i < numbers[1]; i += 10) {
			double steps = steps_at(pulses, (double)first_ns + i * period_ns);
			double expected = 350 + steps * 360 / STEPS;

			if (steps < 0)
				continue;
			*ret_right +=
				fabs(remainder(azimuth[i] * 180 / G_PI - expected, 360)) < 1e-4;
			checked++;
		}
	return checked;
}

static void test_pulses_turn_the_beams(void)
{
	g_autofree char *dir = g_dir_make_tmp("sim-kernel-XXXXXX", NULL),
			*path = g_build_filename(dir, "truth", NULL);
	g_autofree char *description =
		g_strdup_printf("hall?lidar=cola&beams=271&home_deg=350&latency_ms=55&jitter_ms=0&"
				"camera=none&truth=%s",
			path);
	struct bench *b = start(description);
	g_autoptr(GArray) pulses = turn(b, 500);

	g_usleep(200000);
	stop(b);
	FILE *file = fopen(path, "r");

	g_assert_nonnull(file);
	guint right = 0, checked = check_beams(file, pulses, &right);

	fclose(file);
	g_remove(path);
	g_rmdir(dir);
	if (checked < 50)
		g_test_skip("the machine is too busy to tell of pulses in time");
	else /* whoever is told is busy at times, too */
		g_assert_cmpuint(right * 10, >=, checked * 8);
}

/* The endpoint halts, is cleared and goes on; then the plug is out amid a telegram, and in again after a while. */
static void test_faults(void)
{
	struct bench *b = start("hall?lidar=cola&beams=271&home_deg=350&latency_ms=55&camera=none&"
				"fault=epstall@10,unplug@60:0.5");
	g_autoptr(GArray) pulses = turn(b, 330 + 150);

	g_assert_cmpuint(b->halts, ==, READS);
	g_assert_false(b->unplugged);
	gsize before = b->text->len;
	g_autoptr(GArray) more = turn(b, 250);

	while (!b->unplugged)
		take_answer(b);
	g_assert_cmpuint(b->text->len, >, before);
	g_assert_cmpint(b->text->str[b->text->len - 1], !=, 3);
	guint refused = 0;

	close(b->usb);
	for (; !import(b); refused++)
		g_usleep(20000);
	g_assert_cmpuint(refused, >, 1);
	b->unplugged = false;
	g_string_set_size(b->text, 0);
	submit(b, 0x81, NULL, NULL, 65536);
	say(b, "sRN DeviceIdent");
	while (b->text->len == 0 && !b->unplugged)
		take_answer(b);
	g_assert_true(g_str_has_prefix(b->text->str, "\2sRA DeviceIdent"));
	stop(b);
}

static void test_wrong_plug(void)
{
	g_autoptr(GError) error = NULL;
	struct kernel_options options = {
		.description = "hall?camera=none", .plug = "sikc", .listens = on_listens
	};

	g_assert_false(kernel_serve(&options, -1, &error));
	g_assert_nonnull(strstr(error->message, "there are sick, hokuyo, cp2102"));
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/sim-kernel/pulses-turn-the-beams", test_pulses_turn_the_beams);
	g_test_add_func("/sim-kernel/faults", test_faults);
	g_test_add_func("/sim-kernel/wrong-plug", test_wrong_plug);
	return g_test_run();
}
