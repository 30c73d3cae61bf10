#include "acquire/advice.h"
#include "acquire/manifest.h"
#include "acquire/pump.h"
#include "firmware-io/record.h"
#include "firmware-io/wire.h"
#include <gio/gio.h>
#include <glib/gi18n.h>

/* Texts are English; the touch screen translates them. */
struct advice {
	GQuark (*domain)(void);
	int code; /* below 0: any */
	const char *text;
};

static const struct advice all[] = {
	{ pump_error_quark, PUMP_ERROR_LIDAR_GONE,
		N_("Look at the lidar's cable and its power, then go on with the scan.") },
	{ pump_error_quark, PUMP_ERROR_NO_ANSWER,
		N_("Switch the lidar off and on, wait ten seconds, then go on with the scan.") },
	{ pump_error_quark, PUMP_ERROR_REFUSED,
		N_("Switch the lidar off and on. If it refuses again, clean its window and let it "
		   "cool.") },
	{ pump_error_quark, PUMP_ERROR_STAGE,
		N_("See that nothing holds the head and the emergency stop is released, then go on "
		   "with "
		   "the scan: the head finds its zero by itself.") },
	{ pump_error_quark, PUMP_ERROR_STOPPED, "" },
	{ pump_error_quark, PUMP_ERROR_ESTOP,
		N_("See that nobody is in danger, release the emergency stop, and press Reset; "
		   "then go "
		   "on with the scan.") },
	{ pump_error_quark, PUMP_ERROR_INTERLOCK,
		N_("Close the cover of the scanner, see that nobody is in danger, and press Reset; "
		   "then "
		   "go on with the scan.") },
	{ pump_error_quark, PUMP_ERROR_NOT_RESET,
		N_("See that nobody is in danger and that the head can turn freely, and press "
		   "Reset.") },
	{ wire_error_quark, -1, N_("Look at the scanner's cables and its power, then try again.") },
	{ record_error_quark, RECORD_ERROR_DAMAGED,
		N_("The record is damaged in the middle. Go on without what is damaged, or copy "
		   "the "
		   "site "
		   "to a drive first.") },
	{ manifest_error_quark, -1,
		N_("A file of the site is broken. Copy the site's folder to a drive before "
		   "anything "
		   "is "
		   "changed.") },
	{ g_file_error_quark, G_FILE_ERROR_NOSPC,
		N_("Make room: copy finished sites to a drive and remove them here, or scan more "
		   "coarsely.") },
	{ g_file_error_quark, G_FILE_ERROR_EXIST,
		N_("Go on with the unfinished scan of this site, or throw it away.") },
	{ g_file_error_quark, G_FILE_ERROR_ACCES,
		N_("The folder cannot be written: choose another one.") },
	{ g_file_error_quark, G_FILE_ERROR_ROFS,
		N_("The disk can only be read: choose another one.") },
	{ g_io_error_quark, G_IO_ERROR_BUSY,
		N_("Another program writes into this site. Wait until it is done.") },
};

const char *advice_for(const GError *error)
{
	for (size_t i = 0; error && i < G_N_ELEMENTS(all); i++)
		if (error->domain == all[i].domain() &&
			(all[i].code < 0 || error->code == all[i].code))
			return all[i].text;
	return "";
}
