#ifndef ACQUIRE_VERSION_H
#define ACQUIRE_VERSION_H
/* Which pleinair this is; who builds packages of it may say more. */

#ifndef PLEINAIR_VERSION
#define PLEINAIR_VERSION "0.1"
#endif

#endif
