#ifndef RENDER_BENCH_MACHINE_H
#define RENDER_BENCH_MACHINE_H
/* What figures were measured on. */
#include <json-glib/json-glib.h>

/* processor, cores (that this program may use), memory_gib, kernel, system, compiler, pleinair (its version), commit (where it was built in
 * its repository), date, load (what else ran in the minute before): as far as they can be told. */
JsonObject *bench_machine(void);
/* "Intel Xeon ..., 2 cores, 23 GiB, Debian GNU/Linux 12 (bookworm)"; caller frees. */
char *bench_machine_line(JsonObject *machine);

#endif
