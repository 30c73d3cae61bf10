#ifndef ACQUIRE_CONFIGURATION_H
#define ACQUIRE_CONFIGURATION_H
/* /etc/pleinair.conf, or the file that $PLEINAIR_CONF names (parts.h): what this machine has. */

/* URI of the head that it names; NULL: none. Caller frees. */
char *configuration_device(void);

#endif
