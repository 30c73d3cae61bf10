#ifndef SIM_CERTIFICATE_H
#define SIM_CERTIFICATE_H
/* The calibration certificate of a simulated head, as JSON: what the maker of a real one would have
 * measured. */
#include "sim/lens.h"
#include "sim/options.h"

/* Without a camera (lens NULL) its part is null. */
char *certificate_json(const sim_options *options, const struct lens *lens);

#endif
