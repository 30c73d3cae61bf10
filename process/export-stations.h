#ifndef PROCESS_EXPORT_STATIONS_H
#define PROCESS_EXPORT_STATIONS_H
/* Which stations go into a file, where they stand in it, and what is known of them. */
#include "process/export-format.h"

/* Fills stations, one_grid, origin and notes: what is left out is told there. */
bool export_find_stations(struct export_job *j, GError **error);
void export_station_free(gpointer station);

#endif
