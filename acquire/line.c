#include "acquire/line.h"
#include "acquire/driver.h"
#include "firmware-io/wire.h"

#define LISTEN_NS INT64_C(300000000)

struct evidence {
	bool bytes; /* some came */
	uint64_t framing_errors;
	enum sniffed foreign; /* another lidar's, or SNIFFED_NOTHING */
	uint32_t foreign_baud;
};

static enum sniffed foreign_of(const struct pump *p)
{
	enum sniffed what = sniff_what(&p->heard);
	bool known = what > SNIFFED_GARBAGE && what != sniff_of_protocol(p->driver->protocol);
	return known ? what : SNIFFED_NOTHING;
}

static bool complain_of_foreign(
	const struct pump *p, enum sniffed what, const char *where, GError **error)
{
	const char *advice = what == SNIFFED_COLA_B
				     ? "set it to CoLa-A with SICK's SOPAS, then open it as"
				     : "open it as";
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER,
		"another lidar is connected there than '%s' is for: %s%s; %s %s",
		sniff_scheme(sniff_of_protocol(p->driver->protocol)), sniff_name(what), where,
		advice, sniff_scheme(what));
	return false;
}

bool line_complain(struct pump *p, const char *silent, GError **error)
{
	enum sniffed foreign = foreign_of(p);
	if (foreign)
		return complain_of_foreign(p, foreign, "", error);
	if (p->heard.total == 0)
		g_set_error_literal(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER, silent);
	else
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER,
			"what is connected there says something, but nothing that makes sense: is "
			"it the right device, and is its line set to the right speed?");
	return false;
}

static char *speeds_text(const uint32_t *speeds_baud)
{
	GString *text = g_string_new(NULL);
	for (size_t i = 0; speeds_baud[i]; i++)
		g_string_append_printf(text, "%s%u",
			i == 0               ? ""
			: speeds_baud[i + 1] ? ", "
					     : " or ",
			speeds_baud[i]);
	return g_string_free(text, FALSE);
}

static bool complain(
	struct pump *p, const struct line_search *search, const struct evidence *e, GError **error)
{
	g_autofree char *speeds = speeds_text(search->speeds_baud);
	g_autofree char *where = g_strdup_printf(", at %u baud", e->foreign_baud);
	g_autofree char *framing = e->framing_errors ? g_strdup_printf(" (%" G_GUINT64_FORMAT
								       " bytes were cut wrongly)",
							       e->framing_errors)
						     : g_strdup("");
	if (e->foreign)
		return complain_of_foreign(p, e->foreign, where, error);
	if (!e->bytes)
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER,
			"no byte comes from the lidar, at %s baud: does it have power, and is it "
			"plugged in at this port?",
			speeds);
	else
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_NO_ANSWER,
			"bytes come, but nothing that makes sense at %s baud%s: is another device "
			"connected there, or one that was set to another speed?",
			speeds, framing);
	return false;
}

static void look_at(struct pump *p, uint32_t baud, uint64_t framing_before, struct evidence *e)
{
	enum sniffed foreign = foreign_of(p);
	e->bytes |= p->heard.total > 0;
	e->framing_errors += wire_count(p->head->lidar).framing_errors - framing_before;
	if (foreign && !e->foreign) {
		e->foreign = foreign;
		e->foreign_baud = baud;
	}
}

/* Others' lidars speak at speeds of their own: to say which it is, listen at those too. */
static bool listen_elsewhere(
	struct pump *p, const struct line_search *search, struct evidence *e, GError **error)
{
	static const uint32_t speeds_baud[] = { 115200, 230400, 256000, 460800, 921600, 1000000 };
	for (size_t i = 0; i < G_N_ELEMENTS(speeds_baud) && !e->foreign; i++) {
		struct wire_line line = { .baud = speeds_baud[i], .dtr = search->dtr };
		const uint32_t *tried = search->speeds_baud;
		while (*tried && *tried != line.baud)
			tried++;
		if (*tried)
			continue;
		p->heard = (struct sniff){ 0 };
		if (!wire_set_line(p->head->lidar, &line, error) || !pump_for(p, LISTEN_NS, error))
			return false;
		look_at(p, line.baud, wire_count(p->head->lidar).framing_errors, e);
	}
	return true;
}

bool line_find(struct pump *p, const struct line_search *search, GError **error)
{
	struct evidence e = { 0 };
	for (const uint32_t *baud = search->speeds_baud; *baud; baud++) {
		struct wire_line line = { .baud = *baud, .dtr = search->dtr };
		uint64_t framing_before = wire_count(p->head->lidar).framing_errors;
		bool there = false;
		if (!wire_set_line(p->head->lidar, &line, error))
			return false;
		p->heard = (struct sniff){ 0 };
		if (!search->is_there(p, &there, error))
			return false;
		if (there) {
			p->line = line;
			return true;
		}
		look_at(p, *baud, framing_before, &e);
	}
	if (e.bytes && !e.foreign && !listen_elsewhere(p, search, &e, error))
		return false;
	return complain(p, search, &e, error);
}
