#include "sim/rplidar-frames.h"
#include <math.h>

#define BEAMS_OF_ULTRA 3 /* in a word */
#define NO_PREDICTION  0x1ff

void rplidar_put_number(GByteArray *out, uint64_t value, int bytes)
{
	for (; bytes > 0; bytes--, value >>= 8) {
		guint8 byte = (guint8)value;

		g_byte_array_append(out, &byte, 1);
	}
}

void rplidar_put_descriptor(GByteArray *out, uint8_t type, uint32_t length, bool loops)
{
	rplidar_put_number(out, 0x5aa5, 2);
	rplidar_put_number(out, length | (loops ? 0x40000000u : 0), 4);
	rplidar_put_number(out, type, 1);
}

uint8_t rplidar_type_of(enum sim_format format)
{
	static const uint8_t types[SIM_FORMATS] = { 0, 0x81, 0x82, 0x84, 0x85, 0x86, 0x83 };

	return types[format];
}

/* Degrees, the shares of a turn. */
static double degrees(double turns)
{
	return (turns - floor(turns)) * 360;
}

static uint32_t millimetres(const struct echo *echo, uint32_t most)
{
	return echo->outcome == ECHO_GOOD ? (uint32_t)MIN(lrint(echo->range_m * 1000), (long)most)
					  : 0;
}

static uint32_t quarters(const struct echo *echo, double most)
{
	return echo->outcome == ECHO_GOOD ? (uint32_t)fmin(rint(echo->range_m * 4000), most) : 0;
}

static uint32_t quality(const struct echo *echo, uint32_t most)
{
	return echo->outcome == ECHO_GOOD
		       ? (uint32_t)CLAMP(
				 lrint(most * sqrt(fmax((double)echo->strength, 0))), 1, (long)most)
		       : 0;
}

/* A turn begins with the first beam past straight ahead. */
static bool begins_turn(const struct rplidar_portion *p, uint32_t i, double beam_turns)
{
	return floor(p->turns[i]) != floor(p->turns[i] - beam_turns);
}

static double beam_turns(const struct rplidar_portion *p, uint32_t i)
{
	return i > 0 ? p->turns[i] - p->turns[i - 1] : p->turns[1] - p->turns[0];
}

/* Of the first beam, in 64ths of a degree. */
static uint32_t start_q6(const struct rplidar_portion *p, uint32_t i)
{
	return (uint32_t)lround(degrees(p->turns[i]) * 64) % (360 * 64);
}

static void put_standard(GByteArray *out, const struct rplidar_portion *p, uint32_t i)
{
	bool start = begins_turn(p, i, beam_turns(p, i));

	rplidar_put_number(out, (start ? 1u : 2u) | quality(&p->echoes[i], 63) << 2, 1);
	rplidar_put_number(out, start_q6(p, i) << 1 | 1, 2);
	rplidar_put_number(out, quarters(&p->echoes[i], 65535), 2);
}

static void put_hq(GByteArray *out, const struct rplidar_portion *p, uint32_t first)
{
	guint begin = out->len;
	uint32_t crc = 0xffffffff;

	rplidar_put_number(out, 0xa5, 1);
	rplidar_put_number(out, p->stamp_us + (uint64_t)llrint(first * p->beat_us), 8);
	for (uint32_t i = first; i < first + 96; i++) {
		bool start = begins_turn(p, i, beam_turns(p, i));

		rplidar_put_number(
			out, (uint32_t)lround(degrees(p->turns[i]) / 90 * 16384) & 0xffff, 2);
		rplidar_put_number(out, quarters(&p->echoes[i], 4e9), 4);
		rplidar_put_number(out, quality(&p->echoes[i], 255), 1);
		rplidar_put_number(out, start, 1);
	}
	/* The sum goes on over zeros up to a multiple of four. */
	for (guint i = 0; i < 780; i++) {
		crc ^= i < 777 ? out->data[begin + i] : 0;
		for (int bit = 0; bit < 8; bit++)
			crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
	}
	rplidar_put_number(out, ~crc, 4);
}

/* The two first bytes of a capsule hold its sum. */
static void sign_capsule(GByteArray *out, guint begin)
{
	guint8 sum = 0;

	for (guint i = begin + 2; i < out->len; i++)
		sum ^= out->data[i];
	out->data[begin] = 0xa0 | (sum & 15);
	out->data[begin + 1] = 0x50 | sum >> 4;
}

static void put_express(GByteArray *out, const struct rplidar_portion *p, uint32_t first)
{
	for (uint32_t i = first; i < first + 32; i += 2) {
		uint32_t turned[2], distance[2];

		for (int k = 0; k < 2; k++) {
			turned[k] = (uint32_t)lround(p->turned_rad[i + k] * 180 / M_PI * 8);
			distance[k] = quarters(&p->echoes[i + k], 65532) & 0xfffc;
			rplidar_put_number(out, distance[k] | turned[k] >> 4, 2);
		}
		rplidar_put_number(out, (turned[0] & 15) | (turned[1] & 15) << 4, 1);
	}
}

/* Twelve bits, coarser the farther: the code, and what it stands for. */
struct coarse {
	uint32_t code, mm, shift;
};

static struct coarse coarsen(uint32_t mm)
{
	static const struct {
		uint32_t base, code, shift;
	} steps[] = { { 16384, 3328, 4 }, { 4096, 1792, 3 }, { 2048, 1280, 2 }, { 512, 512, 1 },
		{ 0, 0, 0 } };
	int i = 0;

	while (mm < steps[i].base)
		i++;
	uint32_t half = steps[i].shift ? 1u << (steps[i].shift - 1) : 0;
	uint32_t code = steps[i].code + ((mm - steps[i].base + half) >> steps[i].shift);

	/* Rounded up into the next step, it is that one's first. */
	if (i > 0 && code >= steps[i - 1].code)
		return (struct coarse){ steps[i - 1].code, steps[i - 1].base, steps[i - 1].shift };
	code = MIN(code, 4095u);
	return (struct coarse){ code, steps[i].base + ((code - steps[i].code) << steps[i].shift),
		steps[i].shift };
}

/* What must be added to a neighbour, in its steps, where ten bits hold that. */
static uint32_t predict(uint32_t mm, const struct coarse *from)
{
	double steps = rint(((double)mm - from->mm) / (1 << from->shift));

	return mm == 0 || steps > 510 || steps < -511 ? NO_PREDICTION
						      : (uint32_t)(int)steps & 0x3ff;
}

static void put_ultra(GByteArray *out, const struct rplidar_portion *p, uint32_t first)
{
	for (uint32_t i = first; i < first + 96; i += BEAMS_OF_ULTRA) {
		struct coarse here = coarsen(millimetres(&p->echoes[i], 28672));
		struct coarse next = coarsen(millimetres(&p->echoes[i + BEAMS_OF_ULTRA], 28672));
		const struct coarse *base = here.mm == 0 && next.mm != 0 ? &next : &here;

		rplidar_put_number(out,
			here.code | predict(millimetres(&p->echoes[i + 1], 28672), base) << 12 |
				predict(millimetres(&p->echoes[i + 2], 28672), &next) << 22,
			4);
	}
}

static void put_dense(GByteArray *out, const struct rplidar_portion *p, uint32_t first)
{
	for (uint32_t i = first; i < first + 40; i++)
		rplidar_put_number(out, millimetres(&p->echoes[i], 65535), 2);
}

/* Twenty bits: steps of 2, 3, 4 or 5 mm, and as many bits of quality as are left. */
static uint32_t scaled(const struct echo *echo)
{
	static const struct {
		uint32_t below_mm, from_mm, step_mm, quality_bits, quality_shift;
	} scales[] = { { 2046, 0, 2, 8, 12 }, { 8187, 2046, 3, 7, 13 }, { 24567, 8187, 4, 6, 14 },
		{ 0xffffffff, 24567, 5, 5, 15 } };
	uint32_t mm = millimetres(echo, 60000), s = 0;

	while (mm >= scales[s].below_mm)
		s++;
	uint32_t steps = (mm - scales[s].from_mm + scales[s].step_mm / 2) / scales[s].step_mm;
	uint32_t most = (1u << (scales[s].quality_shift - 2)) - 1;

	return s | MIN(steps, most) << 2 |
	       quality(echo, (1u << scales[s].quality_bits) - 1) << scales[s].quality_shift;
}

static void put_ultra_dense(GByteArray *out, const struct rplidar_portion *p, uint32_t first)
{
	for (uint32_t i = first; i < first + 64; i += 2) {
		uint32_t a = scaled(&p->echoes[i]), b = scaled(&p->echoes[i + 1]);

		rplidar_put_number(out, a & 0xffff, 2);
		rplidar_put_number(out, b & 0xffff, 2);
		rplidar_put_number(out, a >> 16 | b >> 16 << 4, 1);
	}
}

static void put_capsule(
	GByteArray *out, enum sim_format format, const struct rplidar_portion *p, uint32_t first)
{
	guint begin = out->len;

	rplidar_put_number(out, 0, 2);
	if (format == SIM_ULTRA_DENSE) {
		rplidar_put_number(out, p->stamp_us + (uint64_t)llrint(first * p->beat_us), 4);
		rplidar_put_number(out, 0, 2);
	}
	rplidar_put_number(out, start_q6(p, first) | (p->first && first == 0 ? 0x8000 : 0), 2);
	switch (format) {
	case SIM_EXPRESS: put_express(out, p, first); break;
	case SIM_ULTRA: put_ultra(out, p, first); break;
	case SIM_DENSE: put_dense(out, p, first); break;
	default: put_ultra_dense(out, p, first); break;
	}
	sign_capsule(out, begin);
}

void rplidar_put_portion(GByteArray *out, enum sim_format format, const struct rplidar_portion *p)
{
	static const uint32_t samples[SIM_FORMATS] = { 1, 1, 32, 96, 40, 64, 96 };

	for (uint32_t first = 0; first + samples[format] <= p->beams; first += samples[format])
		if (format == SIM_STANDARD)
			put_standard(out, p, first);
		else if (format == SIM_HQ)
			put_hq(out, p, first);
		else
			put_capsule(out, format, p, first);
}

/* The lens and the laser stand apart, so the beam leaves at a slant that the spot's place on the
 * sensor tells; express capsules say it themselves, in eighths of a degree. */
double rplidar_turned_rad(enum sim_format format, double range_m)
{
	int quarter_mm = (int)lround(range_m * 1000) * 4;
	int part = quarter_mm >= 200 ? 98361 / quarter_mm : 0;
	double turned =
		quarter_mm >= 200
			? 8 * M_PI / 180 - (part * 64 + part * part * part / 98304) / 65536.0
			: 7.5 * M_PI / 180;

	if (format == SIM_EXPRESS)
		return MIN(lround(turned * 180 / M_PI * 8), 63) / 8.0 * M_PI /
		       180; /* in six bits */
	return format == SIM_ULTRA ? turned : 0;
}
