#include "acquire/driver.h"
#include <string.h>

static const struct driver *const drivers[] = { &driver_scip, &driver_cola, &driver_ld,
	&driver_rplidar };

const struct driver *driver_find(const char *protocol)
{
	for (size_t i = 0; i < G_N_ELEMENTS(drivers); i++)
		if (strcmp(drivers[i]->protocol, protocol) == 0)
			return drivers[i];
	return NULL;
}
