#ifndef RENDER_KIOSK_DEVICE_SHEET_H
#define RENDER_KIOSK_DEVICE_SHEET_H
/* Which scanner is used: its URI, typed or one of those that are common. */
#include "render/kiosk/kiosk.h"

void device_sheet_open(kiosk *k);

#endif
