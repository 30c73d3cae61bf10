#ifndef SIM_HEAD_STAGE_H
#define SIM_HEAD_STAGE_H
/* The stage of a head as it stands at power-on. */
#include "sim/options.h"
#include "sim/stage.h"

struct stage_desc sim_head_stage(const sim_options *options, int64_t now_ns);

#endif
