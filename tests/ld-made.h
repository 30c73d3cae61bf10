#ifndef TESTS_LD_MADE_H
#define TESTS_LD_MADE_H
/* Packets of LDRobot's lidars written from the layout, on their own, and a decoder to give them to. */
#include "tests/collect.h"
#include <math.h>

struct made_motor {
	double samples_hz, turns_hz;
	uint64_t next; /* measurement */
	double start_turns, start_ms;
};

static inline uint8_t made_sum(const uint8_t *bytes, size_t length)
{
	uint8_t crc = 0;
	for (size_t i = 0; i < length; i++)
		for (int bit = 7; bit >= 0; bit--) {
			bool one = (crc >> 7 ^ bytes[i] >> bit) & 1;
			crc = (uint8_t)(crc << 1 ^ (one ? 0x4d : 0));
		}
	return crc;
}

static inline uint32_t made_range(uint64_t i)
{
	return i % 50 == 7 ? 0 : (uint32_t)(500 + i * 37 % 9000);
}

static inline double made_turns(const struct made_motor *m, uint64_t i)
{
	return m->start_turns + (double)i * m->turns_hz / m->samples_hz;
}

static inline void made_u16(uint8_t *at, double value)
{
	at[0] = (uint8_t)lround(value);
	at[1] = (uint8_t)(lround(value) >> 8);
}

/* The next twelve measurements. */
static inline void made_packet(struct made_motor *m, uint8_t ret[47])
{
	double first = made_turns(m, m->next), last = made_turns(m, m->next + 11);
	double ms = m->start_ms + (double)(m->next + 11) * 1000 / m->samples_hz;
	ret[0] = 0x54;
	ret[1] = 0x2c;
	made_u16(ret + 2, 360 * m->turns_hz);
	made_u16(ret + 4, fmod(round((first - floor(first)) * 36000), 36000));
	for (uint64_t i = 0; i < 12; i++) {
		made_u16(ret + 6 + 3 * i, made_range(m->next + i));
		ret[8 + 3 * i] = (uint8_t)(m->next + i);
	}
	made_u16(ret + 42, fmod(round((last - floor(last)) * 36000), 36000));
	made_u16(ret + 44, fmod(floor(ms), 30000));
	ret[46] = made_sum(ret, 46);
	m->next += 12;
}

/* When its last byte is there, and a little later. */
static inline int64_t made_arrival_ns(const struct made_motor *m)
{
	return (int64_t)((double)(m->next - 1) * 1e9 / m->samples_hz) + 5000000;
}

#endif
