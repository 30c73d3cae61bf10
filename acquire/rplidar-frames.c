#include "acquire/rplidar-frames.h"
#include <glib.h>
#include <math.h>
#include <string.h>
#include <zlib.h>

#define Q6_RAD ((float)(G_PI / 180 / 64))

static const struct layout {
	uint8_t type;
	uint16_t bytes, samples;
	uint8_t start_at; /* of the first angle */
	uint8_t cabins_at;
} layouts[RPLIDAR_FORMATS] = {
	[RPLIDAR_STANDARD] = { 0x81, 5, 1 },
	[RPLIDAR_EXPRESS] = { 0x82, 84, 32, 2, 4 },
	[RPLIDAR_ULTRA] = { 0x84, 132, 96, 2, 4 },
	[RPLIDAR_DENSE] = { 0x85, 84, 40, 2, 4 },
	[RPLIDAR_ULTRA_DENSE] = { 0x86, 170, 64, 8, 10 },
	[RPLIDAR_HQ] = { 0x83, 781, 96 },
};

static uint32_t u16(const uint8_t *at)
{
	return at[0] | (uint32_t)at[1] << 8;
}

static uint32_t u32(const uint8_t *at)
{
	return u16(at) | u16(at + 2) << 16;
}

bool rplidar_is_descriptor(const uint8_t *b, struct rplidar_descriptor *ret)
{
	static const uint8_t replies[] = { 0x04, 0x06, 0x14, 0x15, 0x20, 0x21, 0xff };
	if (b[0] != 0xa5 || b[1] != 0x5a)
		return false;
	uint32_t length = u32(b + 2) & 0x3fffffff, mode = b[5] >> 6;
	*ret = (struct rplidar_descriptor){ .type = b[6], .length = length, .loops = mode == 1 };
	for (int f = 0; mode == 1 && f < RPLIDAR_FORMATS; f++)
		if (layouts[f].type == b[6] && layouts[f].bytes == length) {
			ret->format = (enum rplidar_format)f;
			return true;
		}
	return mode == 0 && length > 0 && length <= RPLIDAR_REPLY_BYTES_MAX &&
	       memchr(replies, b[6], sizeof replies);
}

uint8_t rplidar_answer_type(enum rplidar_format format)
{
	return layouts[format].type;
}

size_t rplidar_frame_bytes(enum rplidar_format format)
{
	return layouts[format].bytes;
}

uint32_t rplidar_frame_samples(enum rplidar_format format)
{
	return layouts[format].samples;
}

static bool is_hq(const uint8_t *b)
{
	static const uint8_t padding[3];
	uint32_t length = RPLIDAR_FRAME_BYTES_MAX - 4;
	if (b[0] != 0xa5)
		return false;
	uLong crc = crc32(crc32(0, b, length), padding, 4 - (length & 3));
	return crc == u32(b + length);
}

bool rplidar_is_frame(enum rplidar_format format, const uint8_t *b)
{
	if (format == RPLIDAR_STANDARD)
		return rplidar_is_node(b);
	if (format == RPLIDAR_HQ)
		return is_hq(b);
	if (b[0] >> 4 != 0xa || b[1] >> 4 != 0x5)
		return false;
	uint8_t sum = 0;
	for (unsigned i = 2; i < layouts[format].bytes; i++)
		sum ^= b[i];
	return sum == ((b[0] & 15) | ((b[1] & 15) << 4));
}

bool rplidar_has_content(enum rplidar_format format, const uint8_t *b)
{
	unsigned changes = 0;
	for (unsigned i = 1; i < layouts[format].bytes; i++)
		changes += b[i] != b[i - 1];
	return changes > layouts[format].bytes / 8u;
}

uint32_t rplidar_start_q6(enum rplidar_format format, const uint8_t *b)
{
	return (u16(b + layouts[format].start_at) & 0x7fff) % RPLIDAR_TURN_Q6;
}

bool rplidar_begins_anew(enum rplidar_format format, const uint8_t *b)
{
	return b[layouts[format].start_at + 1] & 0x80;
}

bool rplidar_stamp_us(enum rplidar_format format, const uint8_t *b, uint64_t *ret)
{
	if (format == RPLIDAR_ULTRA_DENSE)
		*ret = u32(b + 2);
	else if (format == RPLIDAR_HQ)
		*ret = u32(b + 1) | (uint64_t)u32(b + 5) << 32;
	return format == RPLIDAR_ULTRA_DENSE || format == RPLIDAR_HQ;
}

/* Ranges in quarters of a millimetre become millimetres. */
static inline uint32_t to_mm(uint32_t range_q2)
{
	return (range_q2 + 2) >> 2;
}

/* The angle of each, less what the device says, in eighths of a degree. */
static void decode_express(const uint8_t *b, float start, float step, struct rplidar_samples *ret)
{
	for (int k = 0; k < 16; k++, b += 5) {
		uint32_t first = u16(b), second = u16(b + 2);
		float less1 = (float)((b[4] & 15) | (first & 3) << 4),
		      less2 = (float)(b[4] >> 4 | (second & 3) << 4);
		ret->range_mm[2 * k] = to_mm(first & 0xfffc);
		ret->range_mm[2 * k + 1] = to_mm(second & 0xfffc);
		ret->clockwise_rad[2 * k] = start + step * (float)(2 * k) - 8 * Q6_RAD * less1;
		ret->clockwise_rad[2 * k + 1] =
			start + step * (float)(2 * k + 1) - 8 * Q6_RAD * less2;
	}
}

/* Distances of 12 bits, coarser the farther: which is a table of 4096, of the value and of the shift
 * below it. */
static struct major {
	uint16_t mm;
	uint8_t shift;
} majors[4096];
/* What a distance, in quarters of a millimetre, turns the beam by: its divisor alone matters, and
 * that is below the table's end. */
#define TURNED_NEAR_Q2 200
#define TURNED_DIVISOR 98361
static float turned_rad[TURNED_DIVISOR / TURNED_NEAR_Q2 + 1];
static float turned_near_rad;

static struct major major_of(uint32_t raw)
{
	static const struct {
		uint16_t from, base;
		uint8_t shift;
	} scales[] = { { 3328, 16384, 4 }, { 1792, 4096, 3 }, { 1280, 2048, 2 }, { 512, 512, 1 },
		{ 0, 0, 0 } };
	int i = 0;
	while (raw < scales[i].from)
		i++;
	uint32_t mm = scales[i].base + ((raw - scales[i].from) << scales[i].shift);
	return (struct major){ (uint16_t)mm, scales[i].shift };
}

static float q16_rad(int q16)
{
	return (float)(q16 / 65536.0);
}

static void make_tables(void)
{
	static gsize made;
	if (!g_once_init_enter(&made))
		return;
	for (uint32_t raw = 0; raw < 4096; raw++)
		majors[raw] = major_of(raw);
	for (int k = 0; k < (int)G_N_ELEMENTS(turned_rad); k++)
		turned_rad[k] =
			q16_rad((int)(8 * G_PI * 65536 / 180) - (k << 6) - k * k * k / 98304);
	turned_near_rad = q16_rad((int)(7.5 * G_PI * 65536 / 180));
	g_once_init_leave(&made, 1);
}

static inline uint32_t predicted(int prediction, struct major base)
{
	int mm = base.mm + prediction * (1 << base.shift);
	return prediction == -512 || prediction == 511 || mm < 0 ? 0 : (uint32_t)mm;
}

static void decode_ultra(
	const uint8_t *b, const uint8_t *next, float start, float step, struct rplidar_samples *ret)
{
	make_tables();
	struct major here = majors[u32(b) & 0xfff];
	for (int k = 0; k < 32; k++, b += 4) {
		int32_t cabin = (int32_t)u32(b);
		const uint8_t *behind = k < 31 ? b + 4 : next;
		struct major then = behind ? majors[u32(behind) & 0xfff] : here;
		/* Signed, of ten bits each. */
		int first = (int32_t)((uint32_t)cabin << 10) >> 22, second = cabin >> 22;
		ret->range_mm[3 * k] = here.mm;
		ret->range_mm[3 * k + 1] =
			predicted(first, here.mm == 0 && then.mm != 0 ? then : here);
		ret->range_mm[3 * k + 2] = behind ? predicted(second, then) : 0;
		here = then;
	}
	for (int i = 0; i < 96; i++) {
		uint32_t q2 = ret->range_mm[i] << 2;
		float turned = q2 >= TURNED_NEAR_Q2 ? turned_rad[(int)(TURNED_DIVISOR / (float)q2)]
						    : turned_near_rad;
		ret->clockwise_rad[i] = start + step * (float)i - turned;
	}
}

static void decode_dense(const uint8_t *b, float start, float step, struct rplidar_samples *ret)
{
	for (int i = 0; i < 40; i++) {
		ret->range_mm[i] = u16(b + 2 * i);
		ret->clockwise_rad[i] = start + step * (float)i;
	}
}

/* Twenty bits of range and quality, finer the nearer. */
static inline void decode_scaled(uint32_t v, uint32_t *ret_mm, uint16_t *ret_quality)
{
	static const struct {
		uint32_t mask, factor, from_q2;
		uint8_t shift, quality_shift;
	} scales[] = { { 0xffc, 2, 0, 12, 0 }, { 0x1ffc, 3, 2046 << 2, 13, 1 },
		{ 0x3ffc, 4, 8187 << 2, 14, 2 }, { 0x7ffc, 5, 24567 << 2, 15, 3 } };
	uint32_t s = v & 3;
	*ret_mm = to_mm((v & scales[s].mask) * scales[s].factor + scales[s].from_q2);
	*ret_quality = (uint16_t)(v >> scales[s].shift << scales[s].quality_shift);
}

static void decode_ultra_dense(
	const uint8_t *b, float start, float step, struct rplidar_samples *ret)
{
	for (int k = 0; k < 32; k++, b += 5) {
		decode_scaled(u16(b) | (uint32_t)(b[4] & 15) << 16, &ret->range_mm[2 * k],
			&ret->intensity[2 * k]);
		decode_scaled(u16(b + 2) | (uint32_t)(b[4] >> 4) << 16, &ret->range_mm[2 * k + 1],
			&ret->intensity[2 * k + 1]);
	}
	for (int i = 0; i < 64; i++)
		ret->clockwise_rad[i] = start + step * (float)i;
}

void rplidar_decode_capsule(enum rplidar_format format, const uint8_t *b, const uint8_t *next,
	uint32_t span_q6, struct rplidar_samples *ret)
{
	const struct layout *l = &layouts[format];
	float start = (float)rplidar_start_q6(format, b) * Q6_RAD,
	      step = (float)span_q6 * Q6_RAD / l->samples;
	const uint8_t *cabins = b + l->cabins_at;
	ret->count = l->samples;
	ret->has_intensity = format == RPLIDAR_ULTRA_DENSE;
	switch (format) {
	case RPLIDAR_EXPRESS: decode_express(cabins, start, step, ret); break;
	case RPLIDAR_ULTRA:
		decode_ultra(cabins, next ? next + l->cabins_at : NULL, start, step, ret);
		break;
	case RPLIDAR_DENSE: decode_dense(cabins, start, step, ret); break;
	default: decode_ultra_dense(cabins, start, step, ret); break;
	}
}

bool rplidar_decode_hq(
	const uint8_t *node, float *ret_clockwise_rad, uint32_t *ret_mm, uint16_t *ret_quality)
{
	*ret_clockwise_rad = (float)u16(node) * (float)(G_PI / 2 / 16384);
	*ret_mm = to_mm(u32(node + 2));
	*ret_quality = node[6];
	return node[7] & 1;
}
