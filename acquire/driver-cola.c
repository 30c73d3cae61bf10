/* SICK TiM in CoLa-A (DEVICES 2.1): the dialogue. */
#include "acquire/cola.h"
#include "acquire/driver.h"
#include "acquire/line.h"
#include "acquire/pump.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MILLISECOND_NS INT64_C(1000000)
#define ANSWER_NS      (2000 * MILLISECOND_NS)
#define REBOOT_NS      (15000 * MILLISECOND_NS)

/* "sRN X" is answered by "sRA X", "sWN" by "sWA", "sMN" by "sAN", "sEN" by "sEA"; any by "sFA". */
static char *answer_to(const char *command)
{
	g_auto(GStrv) words = g_strsplit(command, " ", 3);
	const char *type = g_str_equal(words[0], "sRN")   ? "sRA"
			   : g_str_equal(words[0], "sWN") ? "sWA"
			   : g_str_equal(words[0], "sMN") ? "sAN"
							  : "sEA";
	return g_strdup_printf("%s %s", type, words[1]);
}

static pump_reply *ask(struct pump *p, const char *command, GError **error)
{
	g_autofree char *frame = g_strdup_printf("\x02%s\x03", command),
			*wanted = answer_to(command);
	pump_clear(p);
	if (!pump_send(p, frame, strlen(frame), error))
		return NULL;
	for (pump_reply *r; (r = pump_answer(p, "s", ANSWER_NS, error)); pump_reply_free(r)) {
		if (g_str_has_prefix(r->command, wanted))
			return r;
		if (!g_str_has_prefix(r->command, "sFA"))
			continue;
		g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
			"the lidar refuses '%s': error %s, %s", command, r->status,
			cola_error_text(r->status));
		pump_reply_free(r);
		return NULL;
	}
	g_prefix_error(error, "command '%s': ", command);
	return NULL;
}

static bool order(struct pump *p, const char *command, GError **error)
{
	g_autoptr(pump_reply) r = ask(p, command, error);
	return r != NULL;
}

/* What a device of another firmware may not have; only a lost lidar is an error then. */
static bool order_if_known(struct pump *p, const char *command, GError **error)
{
	g_autoptr(GError) refused = NULL;
	if (order(p, command, &refused) || g_error_matches(refused, PUMP_ERROR, PUMP_ERROR_REFUSED))
		return true;
	g_propagate_error(error, g_steal_pointer(&refused));
	return false;
}

/* The first answer may be spoilt by what the device was saying before. */
static bool wake(struct pump *p, GError **error)
{
	for (int tries = 0; tries < 3; tries++) {
		g_autoptr(GError) silent = NULL;
		if (order_if_known(p, "sEN LMDscandata 0", &silent))
			return true;
		if (!g_error_matches(silent, PUMP_ERROR, PUMP_ERROR_NO_ANSWER)) {
			g_propagate_error(error, g_steal_pointer(&silent));
			return false;
		}
	}
	return line_complain(p,
		"the lidar is silent: is it a SICK TiM set to CoLa-A, and does it have power?",
		error);
}

/* TiM3xx from firmware 2.50 on detect fields only: they send no ranges (DEVICES 2.1.5). */
static bool check_ranging(const char *ident, GError **error)
{
	const char *type = strstr(ident, "TiM3"), *version = strstr(ident, " V");
	double number = version ? g_ascii_strtod(version + 2, NULL) : 0;
	if (!type || number < 2.50)
		return true;
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED,
		"this lidar measures no ranges: a TiM3xx with firmware 2.50 or later only watches "
		"fields (%s)",
		ident);
	return false;
}

/* State 0: busy, 1: ready, 2: error, which a reboot may clear. */
static bool await_ready(struct pump *p, GError **error)
{
	for (int tries = 0; tries < 40; tries++) {
		g_autoptr(pump_reply) r = ask(p, "sRN SCdevicestate", error);
		if (!r)
			return false;
		long state = strtol(r->text, NULL, 16);
		if (state == 1)
			return true;
		if (state == 2 &&
			(!order_if_known(p, "sMN SetAccessMode 3 F4724744", error) ||
				!order_if_known(p, "sMN mSCreboot", error) ||
				!pump_for(p, REBOOT_NS, error) || !pump_open_lidar(p, error)))
			return false;
		if (!pump_for(p, 500 * MILLISECOND_NS, error))
			return false;
	}
	g_set_error(error, PUMP_ERROR, PUMP_ERROR_REFUSED, "the lidar does not become ready");
	return false;
}

static bool prepare(struct pump *p, GError **error)
{
	if (!wake(p, error) || !await_ready(p, error))
		return false;
	g_autoptr(pump_reply) ident = ask(p, "sRN DeviceIdent", error);
	return ident && check_ranging(ident->text, error) &&
	       order_if_known(p, "sRN SerialNumber", error) &&
	       order_if_known(p, "sRN FirmwareVersion", error) &&
	       order_if_known(p, "sRN LMPscancfg", error) && order(p, "sRN LMPoutputRange", error);
}

/* Intensities of sixteen bits, or of eight, where the device lets itself be configured. */
static bool configure_output(struct pump *p, GError **error)
{
	g_autoptr(GError) refused = NULL;
	if (order(p, "sWN LMDscandatacfg 01 00 1 1 0 00 00 0 0 0 0 +1", &refused))
		return true;
	if (g_error_matches(refused, PUMP_ERROR, PUMP_ERROR_REFUSED))
		return order_if_known(p, "sWN LMDscandatacfg 01 00 1 0 0 00 00 0 0 0 0 +1", error);
	g_propagate_error(error, g_steal_pointer(&refused));
	return false;
}

static bool start(struct pump *p, GError **error)
{
	return order_if_known(p, "sMN SetAccessMode 3 F4724744", error) &&
	       configure_output(p, error) && order_if_known(p, "sMN Run", error) &&
	       order(p, "sEN LMDscandata 1", error);
}

static bool stop(struct pump *p, GError **error)
{
	return order(p, "sEN LMDscandata 0", error);
}

/* The delay is that from "time of transmission" to the end of a USB transfer of some 5 kB. */
const struct driver driver_cola = {
	.protocol = "cola",
	.clock = { .ticks_hz = 1e6, .wrap_bits = 32, .delay_ns = MILLISECOND_NS },
	.stamp = STAMP_LAST_BEAM,
	.bytes_per_beam = 9.9,
	.prepare = prepare,
	.start = start,
	.stop = stop,
};
