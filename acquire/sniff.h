#ifndef ACQUIRE_SNIFF_H
#define ACQUIRE_SNIFF_H
/* Which protocol do these bytes look like? For messages to people: that another lidar speaks at a
 * port than was thought, or that nobody speaks anything sensible, as at a wrong speed. Only what is
 * nearly certain counts. One owner; plain data, zero is empty. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SNIFF_BYTES 4096

struct sniff {
	uint64_t total; /* that ever came */
	uint32_t length;
	uint8_t bytes[SNIFF_BYTES]; /* the last of them */
};

enum sniffed {
	SNIFFED_NOTHING, /* no byte */
	SNIFFED_GARBAGE, /* some, of nothing that is known */
	SNIFFED_SCIP,
	SNIFFED_COLA,
	SNIFFED_COLA_B, /* the binary dialect, which is not spoken here */
	SNIFFED_LD,
	SNIFFED_RPLIDAR,
};

void sniff_feed(struct sniff *s, const void *bytes, size_t length);
enum sniffed sniff_what(const struct sniff *s);

/* "an RPLIDAR", and how a device of that kind is opened: "rplidar:"; NULL of what is none. */
const char *sniff_name(enum sniffed what);
const char *sniff_scheme(enum sniffed what);
/* Of a decoder's name. */
enum sniffed sniff_of_protocol(const char *protocol);

#endif
