#ifndef PROCESS_ALIKES_H
#define PROCESS_ALIKES_H
/* Where each scan of a site is like itself (pair.h), remembered from one registration to the next, for half of what it takes to
 * prepare a scan is to find that: SITE/poses/.alikes.json. It can be deleted; what is damaged or found otherwise now is found
 * anew. */
#include "acquire/site.h"
#include "process/pair.h"

typedef struct alikes alikes;
/* What the file tells. method: of how they are found. */
alikes *alikes_load(const site *s, const char *method);
void alikes_free(alikes *a); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(alikes, alikes_free)
/* NULL: it is not known of the scan with this fingerprint. Stays until it is set. */
const struct pair_alikes *alikes_get(const alikes *a, const char *fingerprint);
void alikes_set(alikes *a, const char *fingerprint, const struct pair_alikes *is);
/* Writes those of these scans, where something was set. */
bool alikes_save(alikes *a, char *const *fingerprints, guint count, GError **error);

#endif
