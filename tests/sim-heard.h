#ifndef TESTS_SIM_HEARD_H
#define TESTS_SIM_HEARD_H
/* What a simulated lidar says, taken apart for tests by hand and not by the product's decoders. */
#include "sim/rig.h"
#include "sim/scip-text.h"
#include "sim/truth.h"
#include <stdlib.h>
#include <string.h>

static const world *shared; /* hall, seed 1 */

static inline struct rig *start(const char *description)
{
	struct rig *rig = rig_start(
		&(struct sim_head_options){ .description = description, .world = shared });

	g_assert_false(rig->gone);
	return rig;
}

static inline struct rig *start_open(const char *description)
{
	struct rig *rig = start(description);

	g_assert_true(rig_open(rig));
	return rig;
}

static inline void assert_answer(struct rig *rig, const char *command, const char *answer)
{
	g_autofree char *got = rig_ask(rig, command);

	g_assert_cmpstr(got, ==, answer);
}

/* One scan of a SCIP stream. */
struct scan {
	char echo[40];
	uint32_t stamp_ms;
	guint count; /* numbers of three characters */
	uint32_t value[5000];
};

static inline uint32_t decode(const char *text, int characters)
{
	uint32_t number = 0;

	while (characters-- > 0)
		number = number << 6 | (uint32_t)(*text++ - 0x30);
	return number;
}

static inline const char *end_of_line(const char *at, gsize *ret_length)
{
	const char *end = strchr(at, '\n');

	*ret_length = end ? (gsize)(end - at) : 0;
	return end ? end + 1 : NULL;
}

/* Takes one scan from the text and moves on; false at its end. Sums must be right. */
static inline bool next_scan(const char **text, const char *status, struct scan *scan)
{
	g_autoptr(GString) data = g_string_new(NULL);
	const char *line = *text, *next;
	gsize length;

	if (!(next = end_of_line(line, &length)))
		return false;
	g_strlcpy(scan->echo, line, MIN(length + 1, sizeof scan->echo));
	for (int number = 1;; number++) {
		line = next;
		if (!(next = end_of_line(line, &length)))
			return false;
		if (length == 0)
			break;
		g_assert_cmpint(line[length - 1], ==, scip_line_sum(line, length - 1));
		if (number == 1)
			g_assert_true(strncmp(line, status, 2) == 0);
		else if (number == 2)
			scan->stamp_ms = decode(line, 4);
		else
			g_string_append_len(data, line, (gssize)length - 1);
		g_assert_cmpuint(length, <=, 65);
	}
	g_assert_cmpuint(data->len % 3, ==, 0);
	scan->count = (guint)data->len / 3;
	for (guint i = 0; i < scan->count; i++)
		scan->value[i] = decode(data->str + 3 * i, 3);
	*text = next;
	return true;
}

static inline const char *skip_answer(const char *text)
{
	const char *end = strstr(text, "\n\n");

	g_assert_nonnull(end);
	return end + 2;
}

/* A telegram of CoLa-A, walked word by word. */
struct telegram {
	char **words;
	guint count;
	long telegram, scan, status;
	uint32_t end_us, leaves_us;
	guint distances;
	guint first_distance;
	const char *last_words;
};

static inline long hex(const char *word)
{
	char *end;
	long number = strtol(word, &end, 16);

	g_assert_true(*end == '\0' && end != word);
	return number;
}

static inline void telegram_clear(struct telegram *t)
{
	g_clear_pointer(&t->words, g_strfreev);
}

/* Takes the next frame that is a telegram. */
static inline bool next_telegram(const char **text, struct telegram *t)
{
	for (;;) {
		const char *begin = strchr(*text, 2), *end = begin ? strchr(begin, 3) : NULL;

		if (!end)
			return false;
		g_autofree char *body = g_strndup(begin + 1, (gsize)(end - begin - 1));

		*text = end + 1;
		if (!strstr(body, " LMDscandata 1 1 "))
			continue;
		*t = (struct telegram){ .words = g_strsplit(body, " ", -1) };
		t->count = g_strv_length(t->words);
		t->status = hex(t->words[6]);
		t->telegram = hex(t->words[7]);
		t->scan = hex(t->words[8]);
		t->end_us = (uint32_t)hex(t->words[9]);
		t->leaves_us = (uint32_t)hex(t->words[10]);
		t->first_distance = 26;
		t->distances = (guint)hex(t->words[25]);
		return true;
	}
}

#endif
