#include "acquire/turn.h"
#include <math.h>
#include <string.h>

/* A sweep is no longer than this, be it that the mirror stands: differences of ticks must fit 32
 * bits (stream.c). */
#define SWEEP_MAX_NS 2e9
#define BEAMS_MAX    65536u
#define BEAMS_MIN    2u

void turn_clear(struct turn *t)
{
	g_free(t->angle_rad);
	g_free(t->range_mm);
	g_free(t->intensity);
}

static void reserve(struct turn *t, uint32_t beams)
{
	if (beams <= t->room)
		return;
	t->room = MAX(beams, 2 * t->room);
	t->angle_rad = g_renew(float, t->angle_rad, t->room);
	t->range_mm = g_renew(uint32_t, t->range_mm, t->room);
	t->intensity = g_renew(uint16_t, t->intensity, t->room);
}

/* Gives out what there is and begins anew with the next measurement. sent is when the last byte was
 * out, in measurements. */
static void give_out(struct turn *t, decoder *d, double sent, int64_t arrival_ns)
{
	if (t->beams >= BEAMS_MIN && t->sample_ns > 0 && t->rate_hz > 0) {
		struct scanline line = {
			.arrival_ns = arrival_ns,
			.ticks = (uint64_t)((double)t->first * t->sample_ns),
			.sent_ticks = (uint64_t)(sent * t->sample_ns),
			.epoch = t->epoch,
			.angle_rad = t->angle_rad,
			.beam_s = t->sample_ns * 1e-9,
			.scan_rate_hz = t->rate_hz,
			.beams = t->beams,
			.range_mm = t->range_mm,
			.intensity = t->has_intensity ? t->intensity : NULL,
			.range_min_mm = 1,
		};
		d->counts.scanlines++;
		d->sink.scanline(&line, d->sink.user_data);
	}
	t->beams = 0;
	t->whole = false;
}

static void append(struct turn *t, const struct turn_samples *s, uint32_t from, uint32_t n)
{
	reserve(t, t->beams + n);
	if (t->beams == 0)
		t->first = t->index;
	for (uint32_t i = 0; i < n; i++)
		t->angle_rad[t->beams + i] = -s->clockwise_rad[from + i];
	memcpy(t->range_mm + t->beams, s->range_mm + from, n * sizeof *s->range_mm);
	if (s->intensity)
		memcpy(t->intensity + t->beams, s->intensity + from, n * sizeof *s->intensity);
	t->beams += n;
	t->index += n;
}

/* A sweep that has become too long goes on in another line. */
static void keep(
	struct turn *t, decoder *d, const struct turn_samples *s, uint32_t from, uint32_t to)
{
	double beams_max =
		t->sample_ns > 0 ? fmin(SWEEP_MAX_NS / t->sample_ns, BEAMS_MAX) : BEAMS_MAX;
	uint32_t limit = (uint32_t)fmax(beams_max, BEAMS_MIN);
	while (from < to) {
		uint32_t n = MIN(to - from, limit > t->beams ? limit - t->beams : 0);
		if (n > 0)
			append(t, s, from, n);
		from += n;
		if (t->beams >= limit)
			give_out(t, d, (double)t->index, t->arrival_ns);
	}
}

static void end_turn(struct turn *t, decoder *d, double sent, int64_t arrival_ns)
{
	if (t->whole && t->beams >= BEAMS_MIN) {
		t->last_whole = t->beams;
		if (t->sample_ns > 0)
			t->rate_hz = 1e9 / (t->beams * t->sample_ns);
		d->identity.beams = t->beams;
		d->identity.first_angle_rad = 0;
		d->identity.angle_step_rad = -2 * G_PI / t->beams;
		d->identity.scan_rate_hz = t->sample_ns > 0 ? t->rate_hz : 0;
	}
	give_out(t, d, sent, arrival_ns);
	t->whole = true;
}

void turn_add(struct turn *t, decoder *d, const struct turn_samples *s, int64_t arrival_ns)
{
	bool marked = s->marked < s->count;
	double sent = (double)(t->index + s->count - 1 + s->after) +
		      (t->sample_ns > 0 ? s->sent_ns / t->sample_ns : 0);
	uint32_t before = marked ? s->marked : s->count;
	t->arrival_ns = arrival_ns;
	t->has_intensity = s->intensity != NULL;
	keep(t, d, s, 0, before);
	if (marked) {
		end_turn(t, d, sent, arrival_ns);
		keep(t, d, s, before, s->count);
	}
}

/* What was kept came when the last of it did, not when the gap was seen. */
void turn_skip(struct turn *t, decoder *d, uint64_t missing)
{
	give_out(t, d, (double)t->index, t->arrival_ns);
	t->index += missing;
}

void turn_begin_epoch(struct turn *t, decoder *d)
{
	give_out(t, d, (double)t->index, t->arrival_ns);
	turn_restart(t);
}

void turn_restart(struct turn *t)
{
	t->epoch += t->index > 0;
	t->index = 0;
	t->beams = 0;
	t->whole = false;
}
