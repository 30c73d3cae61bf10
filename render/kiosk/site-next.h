#ifndef RENDER_KIOSK_SITE_NEXT_H
#define RENDER_KIOSK_SITE_NEXT_H
/* Where the next scan of a site would see most that is new, by its model. */
#include "process/next-station.h"
#include "render/drawn-site.h"

/* d is loaded. false: there is no such place, or no scanner stood anywhere (a cloud that was imported). *ret_searched: whether the
 * scanners' places are known at all. Any thread. */
bool site_next_find(const drawn_site *d, struct next_station *ret, bool *ret_searched);

#endif
