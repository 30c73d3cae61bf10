/* The simulated stage driven by pulses that are told of late, in batches, as an agent behind a kernel tells of them. */
#include "sim/link.h"
#include "sim/stage.h"
#include <math.h>
#include <string.h>

#define STEPS    3600
#define SLOTS    36
#define BACKLASH 4.0
#define MS       INT64_C(1000000)

struct drive {
	stage *stage;
	int64_t told_ns; /* of pulses before this the stage was told */
	double next_ns;
	int64_t count;
	GArray *batch;         /* int64_t: when each pulse was */
	guint slots[2], homes; /* clockwise, counter-clockwise */
};

static struct drive begin(void)
{
	struct stage_desc desc = { .steps_per_turn = STEPS,
		.index_slots = SLOTS,
		.initial_azimuth_rad = 350.85 * G_PI / 180,
		.backlash_steps = BACKLASH,
		.clock = { .tick_ns = 1e3, .bits = 32 } };
	struct drive d = { .stage = stage_new(&desc, 0), .next_ns = 1e9 };

	d.batch = g_array_new(FALSE, FALSE, sizeof(int64_t));
	stage_begin_pulses(d.stage, 0);
	return d;
}

static void end(struct drive *d)
{
	stage_free(d->stage);
	g_array_unref(d->batch);
}

static void run(struct drive *d, int64_t now_ns)
{
	while (stage_next_ns(d->stage) <= now_ns) {
		g_autoptr(GByteArray) batch = stage_run(d->stage, now_ns);

		for (gsize at = 0; batch && at < batch->len;
			at += sizeof(struct link_stage_event)) {
			struct link_stage_event event;

			memcpy(&event, batch->data + at, sizeof event);
			d->slots[event.direction < 0] += event.kind == LINK_STAGE_INDEX;
			d->homes += event.kind == LINK_STAGE_HOME;
		}
	}
}

static void tell(struct drive *d, int direction, int64_t now_ns)
{
	for (guint i = 0; i < d->batch->len; i++) {
		stage_pulse(d->stage, g_array_index(d->batch, int64_t, i), direction);
		run(d, now_ns);
	}
	g_array_set_size(d->batch, 0);
	d->told_ns = now_ns;
}

/* Pulses at a pace that goes up and down again, told of in batches up to lateness_ms old. */
static void turn(struct drive *d, int steps, int lateness_ms)
{
	int n = abs(steps), direction = steps < 0 ? -1 : 1;

	for (int i = 0; i < n; i++) {
		int64_t at_ns = llrint(d->next_ns);

		g_array_append_val(d->batch, at_ns);
		d->next_ns += 1e9 / (60 + 1200 * sin(G_PI * (i + 0.5) / n));
		run(d, at_ns);
		if (at_ns - d->told_ns >= lateness_ms * MS)
			tell(d, direction, at_ns);
	}
	tell(d, direction, llrint(d->next_ns));
	d->count += steps;
	d->next_ns += 300e6;
	run(d, llrint(d->next_ns));
}

static double azimuth_steps(const struct drive *d)
{
	return (stage_azimuth_rad(d->stage, llrint(d->next_ns), 0) * 180 / G_PI - 350.85) * STEPS /
	       360;
}

/* Each slot once, the home slot once, however late the pulses are; at rest the head is where they took it, but for the gear's play. */
static void test_slots(gconstpointer data)
{
	int lateness_ms = GPOINTER_TO_INT(data);
	struct drive d = begin();

	turn(&d, STEPS, lateness_ms);
	g_assert_cmpuint(d.slots[0], ==, SLOTS);
	g_assert_cmpuint(d.slots[1], ==, 0);
	g_assert_cmpuint(d.homes, ==, 1);
	g_assert_cmpfloat_with_epsilon(azimuth_steps(&d), STEPS - BACKLASH, 1e-6);
	turn(&d, -STEPS, lateness_ms);
	g_assert_cmpuint(d.slots[0], ==, SLOTS);
	g_assert_cmpuint(d.slots[1], ==, SLOTS);
	g_assert_cmpuint(d.homes, ==, 2);
	g_assert_cmpfloat_with_epsilon(azimuth_steps(&d), 0, 1e-6);
	end(&d);
}

/* The first steps the other way only take up the play. */
static void test_play(void)
{
	struct drive d = begin();

	turn(&d, 100, 20);
	for (int steps = 1; steps <= 3; steps++) {
		turn(&d, -1, 20);
		g_assert_cmpfloat_with_epsilon(azimuth_steps(&d), 100 - BACKLASH, 1e-6);
	}
	turn(&d, -5, 20);
	g_assert_cmpfloat_with_epsilon(azimuth_steps(&d), 92, 1e-6);
	end(&d);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_data_func("/sim-pulses/slots-at-once", GINT_TO_POINTER(0), test_slots);
	g_test_add_data_func("/sim-pulses/slots-late", GINT_TO_POINTER(15), test_slots);
	g_test_add_data_func("/sim-pulses/slots-very-late", GINT_TO_POINTER(700), test_slots);
	g_test_add_func("/sim-pulses/play", test_play);
	return g_test_run();
}
