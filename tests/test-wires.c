/* What brings a lidar's bytes: the inbox between threads, and serial lines, of which a pseudo-terminal's far end is the lidar here. */
#include "firmware-io/head.h"
#include "firmware-io/inbox.h"
#include "firmware-io/parts.h"
#include "tests/simulated.h"
#include <asm/termbits.h>
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define SECOND_NS INT64_C(1000000000)

/* ---- the inbox ---- */

static void test_inbox_order(void)
{
	g_autoptr(inbox) box = inbox_new(64);
	uint8_t got[64];
	int64_t at_ns;
	g_autoptr(GError) error = NULL;
	g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, &error), ==, 0);
	/* Round and round the ring. */
	for (int turn = 0; turn < 40; turn++) {
		char first[24], second[24];
		int a = g_snprintf(first, sizeof first, "first of %d", turn),
		    b = g_snprintf(second, sizeof second, "and second %d", turn);
		inbox_put(box, first, (size_t)a, 100 + turn);
		inbox_put(box, second, (size_t)b, 200 + turn);
		/* A piece is never mixed with the next, and may be taken in parts. */
		g_assert_cmpint(inbox_take(box, got, 3, &at_ns, &error), ==, 3);
		g_assert_cmpint(
			inbox_take(box, got + 3, sizeof got - 3, &at_ns, &error), ==, a - 3);
		g_assert_cmpmem(got, (size_t)a, first, (size_t)a);
		g_assert_cmpint(at_ns, ==, 100 + turn);
		g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, &error), ==, b);
		g_assert_cmpmem(got, (size_t)b, second, (size_t)b);
		g_assert_cmpint(at_ns, ==, 200 + turn);
	}
	g_assert_no_error(error);
}

static bool is_readable(const inbox *box)
{
	struct pollfd p = { .fd = inbox_fd(box), .events = POLLIN };
	return poll(&p, 1, 0) == 1;
}

static void test_inbox_full(void)
{
	g_autoptr(inbox) box = inbox_new(100);
	uint8_t bytes[101] = { 0 }, got[200];
	int64_t at_ns;
	struct wire_counts c = { .framing_errors = 7 };
	g_assert_false(is_readable(box));
	inbox_put(box, bytes, 60, 1);
	g_assert_true(is_readable(box));
	inbox_put(box, bytes, 41, 2); /* one too many: lost as a whole */
	inbox_put(box, bytes, 40, 3);
	inbox_put(box, bytes, 1, 4);
	inbox_count(box, &c);
	g_assert_cmpuint(c.bytes, ==, 142);
	g_assert_cmpuint(c.lost_bytes, ==, 42);
	g_assert_cmpuint(c.waiting_most, ==, 100);
	g_assert_cmpuint(c.room, ==, 100);
	g_assert_cmpuint(c.framing_errors, ==, 7);
	g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, NULL), ==, 60);
	g_assert_true(is_readable(box));
	g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, NULL), ==, 40);
	g_assert_cmpint(at_ns, ==, 3);
	g_assert_false(is_readable(box));
}

/* The end is told after all that came before it, as often as it is asked for, until the box is cleared. */
static void test_inbox_end(void)
{
	g_autoptr(inbox) box = inbox_new(100);
	uint8_t got[10];
	int64_t at_ns;
	inbox_put(box, "last", 4, 1);
	inbox_fail(box, g_error_new_literal(WIRE_ERROR, WIRE_ERROR_GONE, "first reason"));
	inbox_fail(box, g_error_new_literal(WIRE_ERROR, WIRE_ERROR_GONE, "second reason"));
	g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, NULL), ==, 4);
	for (int i = 0; i < 2; i++) {
		g_autoptr(GError) error = NULL;
		g_assert_true(is_readable(box));
		g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, &error), ==, -1);
		g_assert_error(error, WIRE_ERROR, WIRE_ERROR_GONE);
		g_assert_cmpstr(error->message, ==, "first reason");
	}
	inbox_clear(box);
	g_assert_false(is_readable(box));
	g_assert_cmpint(inbox_take(box, got, sizeof got, &at_ns, NULL), ==, 0);
}

/* Two threads, much more than fits at once: nothing is doubled or moved, and what was lost was counted. */
static gpointer put_many(gpointer data)
{
	for (uint32_t i = 0; i < 200000; i++)
		inbox_put(data, &i, sizeof i, i);
	inbox_fail(data, g_error_new_literal(WIRE_ERROR, WIRE_ERROR_GONE, "over"));
	return NULL;
}

static void test_inbox_threads(void)
{
	g_autoptr(inbox) box = inbox_new(4096);
	GThread *thread = g_thread_new("putter", put_many, box);
	struct pollfd p = { .fd = inbox_fd(box), .events = POLLIN };
	uint64_t taken = 0;
	int64_t last = -1, at_ns;
	for (gssize n = 0; n >= 0;) {
		uint32_t number;
		g_assert_cmpint(poll(&p, 1, 10000), ==, 1);
		while ((n = inbox_take(box, &number, sizeof number, &at_ns, NULL)) > 0) {
			g_assert_cmpint(n, ==, sizeof number);
			g_assert_cmpint(number, ==, at_ns);
			g_assert_cmpint(at_ns, >, last);
			last = at_ns;
			taken += (uint64_t)n;
		}
	}
	g_thread_join(thread);
	struct wire_counts c = { 0 };
	inbox_count(box, &c);
	g_assert_cmpuint(c.bytes, ==, 200000 * sizeof(uint32_t));
	g_assert_cmpuint(taken + c.lost_bytes, ==, c.bytes);
}

/* ---- serial lines ---- */

struct line {
	int far; /* the lidar's end */
	char *path;
	head *head;
};

static void line_begin(struct line *l, const char *scheme)
{
	g_autoptr(GError) error = NULL;
	l->far = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
	g_assert_cmpint(l->far, >=, 0);
	g_assert_cmpint(grantpt(l->far) | unlockpt(l->far), ==, 0);
	l->path = g_strdup(ptsname(l->far));
	g_autofree char *uri = g_strdup_printf("%s:%s", scheme, l->path);
	l->head = head_open(uri, &error);
	g_assert_no_error(error);
}

static void line_end(struct line *l)
{
	head_close(l->head);
	if (l->far >= 0)
		close(l->far);
	g_free(l->path);
}

static void say(const struct line *l, const char *text)
{
	g_assert_cmpint(write(l->far, text, strlen(text)), ==, (gssize)strlen(text));
}

/* All that comes until there is so much of it; NULL with an error. */
static char *hear(const struct line *l, size_t length, GError **error)
{
	g_autoptr(GString) text = g_string_new(NULL);
	int64_t deadline_ns = head_now_ns(l->head) + 10 * SECOND_NS, arrival_ns = 0,
		before_ns = head_now_ns(l->head);
	while (text->len < length && head_now_ns(l->head) < deadline_ns) {
		char bytes[256];
		gssize n = wire_read(l->head->lidar, bytes, sizeof bytes, &arrival_ns, error);
		if (n < 0)
			return NULL;
		g_string_append_len(text, bytes, n);
		if (n > 0)
			g_assert_cmpint(arrival_ns, >=, before_ns - 10 * SECOND_NS);
		if (text->len < length)
			g_assert_true(head_wait(l->head, deadline_ns, error));
	}
	g_assert_cmpint(arrival_ns, <=, head_now_ns(l->head));
	return g_strdup(text->str);
}

/* What the far end would see of the speed; a pseudo-terminal does not care, a lidar does. */
static struct termios2 settings(const struct line *l)
{
	struct termios2 t;
	g_assert_cmpint(ioctl(l->far, TCGETS2, &t), ==, 0);
	return t;
}

static void test_tty_both_ways(void)
{
	struct line l;
	g_autoptr(GError) error = NULL;
	line_begin(&l, "scip");
	g_assert_cmpstr(l.head->lidar_protocol, ==, "scip");
	g_assert_true(wire_open(l.head->lidar, &error));
	/* Nothing is echoed, changed or kept back: control characters and all. */
	const char *all = "\x01\x02\x03\x04\r\n\x11\x13\x1a\x7f\xff end";
	g_assert_true(wire_write(l.head->lidar, all, strlen(all), &error));
	char got[64] = { 0 };
	g_assert_cmpint(read(l.far, got, sizeof got), ==, (gssize)strlen(all));
	g_assert_cmpstr(got, ==, all);
	say(&l, all);
	g_autofree char *heard = hear(&l, strlen(all), &error);
	g_assert_no_error(error);
	g_assert_cmpstr(heard, ==, all);
	struct wire_counts c = wire_count(l.head->lidar);
	g_assert_cmpuint(c.bytes, ==, strlen(all));
	g_assert_cmpuint(c.lost_bytes, ==, 0);
	/* Nobody else shall talk in between; root could. */
	if (geteuid() != 0)
		g_assert_cmpint(open(l.path, O_RDWR | O_NOCTTY | O_CLOEXEC), ==, -1);
	line_end(&l);
}

static void test_tty_speeds(void)
{
	static const uint32_t speeds[] = { 19200, 115200, 230400, 256000, 460800, 921600, 1000000 };
	struct line l;
	g_autoptr(GError) error = NULL;
	line_begin(&l, "rplidar");
	/* Set before it is opened, and after. */
	for (size_t i = 0; i < G_N_ELEMENTS(speeds); i++) {
		g_assert_true(wire_set_line(
			l.head->lidar, &(struct wire_line){ speeds[i], true }, &error));
		if (i == 0)
			g_assert_true(wire_open(l.head->lidar, &error));
		g_assert_no_error(error);
		struct termios2 t = settings(&l);
		g_assert_cmpuint(t.c_ospeed, ==, speeds[i]);
		g_assert_cmpuint(t.c_ispeed, ==, speeds[i]);
		g_assert_cmpuint(t.c_cflag & (CSIZE | PARENB | CSTOPB | CRTSCTS), ==, CS8);
		g_assert_cmpuint(t.c_lflag | t.c_oflag, ==, 0);
	}
	line_end(&l);
}

static void test_tty_unplugged(void)
{
	struct line l;
	g_autoptr(GError) error = NULL, gone = NULL;
	line_begin(&l, "ld");
	g_assert_true(wire_open(l.head->lidar, &error));
	say(&l, "half a tele");
	g_autofree char *half = hear(&l, 11, &error);
	g_assert_cmpstr(half, ==, "half a tele");
	close(l.far);
	l.far = -1;
	g_assert_null(hear(&l, 1, &gone));
	g_assert_error(gone, WIRE_ERROR, WIRE_ERROR_GONE);
	g_assert_nonnull(strstr(gone->message, "unplugged"));
	g_assert_nonnull(strstr(gone->message, l.path));
	wire_close(l.head->lidar);
	/* Not there any more: one can wait for it. */
	g_clear_error(&gone);
	g_assert_false(wire_open(l.head->lidar, &gone));
	g_assert_error(gone, WIRE_ERROR, WIRE_ERROR_GONE);
	line_end(&l);
}

/* What comes while nobody reads is kept, up to the room there is, and then counted. */
static void test_tty_slow_reader(void)
{
	struct line l;
	g_autoptr(GError) error = NULL;
	g_autoptr(GString) sent = g_string_new(NULL);
	line_begin(&l, "ld");
	g_assert_true(wire_open(l.head->lidar, &error));
	for (int i = 0; i < 4000; i++) {
		char text[16];
		g_snprintf(text, sizeof text, "%09d\n", i);
		say(&l, text);
		g_string_append(sent, text);
	}
	g_autofree char *heard = hear(&l, sent->len, &error);
	g_assert_no_error(error);
	g_assert_cmpstr(heard, ==, sent->str);
	g_assert_cmpuint(wire_count(l.head->lidar).lost_bytes, ==, 0);
	line_end(&l);
}

static void refused(const char *uri, const char *words)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(head) h = head_open(uri, &error);
	if (h)
		g_assert_false(wire_open(h->lidar, &error));
	g_assert_nonnull(error);
	g_test_message("%s", error->message);
	g_assert_nonnull(strstr(error->message, words));
}

static void test_words(void)
{
	refused("ld:", "on which port");
	refused("ld:/dev/pleinair-none", "does not exist");
	refused("ld:/dev/null", "is no serial line");
	refused("scip:/etc/hostname", "is no serial line");
	refused("tim:9-9", "USB");
	refused("tim:?stage.setp=4", "no key 'setp' in [stage]");
	refused("tim:?camera", "not of the form group.key=value");
	refused("lidar:", "is none of");
}

/* ---- /etc/pleinair.conf ---- */

static void test_configuration(void)
{
	g_autofree char *folder = simulated_folder(),
			*path = g_build_filename(folder, "conf", NULL);
	g_autoptr(GError) error = NULL;
	double number;
	bool flag;
	g_setenv("PLEINAIR_CONF", path, TRUE);
	g_assert_null(parts_read("tim:", &error)); /* one that was named must be there */
	g_assert_nonnull(strstr(error->message, path));
	g_clear_error(&error);
	g_assert_true(g_file_set_contents(path,
		"[head]\ndevice=tim:\n[stage]\nchip=pins\nstep=STEP\nsteps_per_turn=3200\n", -1,
		NULL));
	g_autoptr(parts) p =
		parts_read("tim:1-2?stage.steps_per_turn=11886&camera.node=none", &error);
	g_assert_no_error(error);
	g_assert_cmpstr(parts_rest(p), ==, "1-2");
	g_assert_cmpstr(parts_text(p, "stage", "chip"), ==, "pins");
	g_assert_cmpstr(parts_text(p, "camera", "node"), ==, "none");
	g_assert_null(parts_text(p, "stage", "dir"));
	g_assert_true(parts_number(p, "stage", "steps_per_turn", 16, 1e8, 1, &number, &error));
	g_assert_cmpfloat(number, ==, 11886);
	g_assert_true(parts_number(p, "stage", "index_slots", 0, 100, 24, &number, &error));
	g_assert_cmpfloat(number, ==, 24);
	g_assert_false(parts_number(p, "stage", "steps_per_turn", 16, 100, 1, &number, &error));
	g_assert_nonnull(
		strstr(error->message, "steps_per_turn=11886 is not a number from 16 to 100"));
	g_clear_error(&error);
	g_assert_false(parts_flag(p, "stage", "chip", true, &flag, &error));
	g_assert_nonnull(strstr(error->message, "neither yes nor no"));
	g_clear_error(&error);
	g_assert_true(g_file_set_contents(path, "[stage]\nestpo=4\n", -1, NULL));
	g_assert_null(parts_read("tim:", &error));
	g_assert_nonnull(strstr(error->message, "no key 'estpo' in [stage]"));
	g_unsetenv("PLEINAIR_CONF");
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/wires/inbox/order", test_inbox_order);
	g_test_add_func("/wires/inbox/full", test_inbox_full);
	g_test_add_func("/wires/inbox/end", test_inbox_end);
	g_test_add_func("/wires/inbox/threads", test_inbox_threads);
	g_test_add_func("/wires/tty/both-ways", test_tty_both_ways);
	g_test_add_func("/wires/tty/speeds", test_tty_speeds);
	g_test_add_func("/wires/tty/unplugged", test_tty_unplugged);
	g_test_add_func("/wires/tty/slow-reader", test_tty_slow_reader);
	g_test_add_func("/wires/words", test_words);
	g_test_add_func("/wires/configuration", test_configuration);
	return g_test_run();
}
