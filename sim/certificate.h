#ifndef SIM_CERTIFICATE_H
#define SIM_CERTIFICATE_H
/* The calibration certificate of a simulated head, as JSON: what the maker of a real one would have measured. A head that was not
 * put together as drawn (mount.h) tells the drawing all the same, unless certificate=true has it tell the truth, or
 * certificate=FILE what somebody found out. */
#include "sim/options.h"

/* Without a camera its part is null. Fails when the file cannot be read. */
char *certificate_json(const sim_options *options, GError **error);

#endif
