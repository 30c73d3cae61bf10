#ifndef TESTS_ACQUISITION_BENCH_H
#define TESTS_ACQUISITION_BENCH_H
/* pleinair-acquired on a bus of the test's own, as whoever asks it sees it. */
#include "acquire/acquisition-bus.h"
#include "tests/bus-bench.h"

/* It may not run yet; caller unrefs. */
static inline BusAcquisition1 *acquisition_reach(struct bus_bench *bus)
{
	g_autoptr(GError) error = NULL;
	BusAcquisition1 *service = bus_acquisition1_proxy_new_sync(bus->connection,
		G_DBUS_PROXY_FLAGS_DO_NOT_AUTO_START, "org.pleinair.Acquisition1",
		"/org/pleinair/Acquisition1", NULL, &error);
	g_assert_no_error(error);
	g_dbus_proxy_set_default_timeout(G_DBUS_PROXY(service), BUS_PATIENCE_S * 1000);
	return service;
}

static inline bool acquisition_is_there(BusAcquisition1 *service)
{
	g_autofree char *owner = g_dbus_proxy_get_name_owner(G_DBUS_PROXY(service));
	return owner && bus_acquisition1_get_state(service);
}

#endif
