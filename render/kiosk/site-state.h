#ifndef RENDER_KIOSK_SITE_STATE_H
#define RENDER_KIOSK_SITE_STATE_H
/* What there is to know of a site on its screen: read at once, on any thread, const after. */
#include "process/scan-graph.h"
#include "render/kiosk/site-next.h"

#define SITE_PLAN_SIDE 640u

typedef struct site_state site_state;
struct site_state {
	char *folder, *name;
	GArray *scans;    /* of uint32_t */
	uint32_t partial; /* 0: none */
	scan_graph *graph;
	guint placed; /* scans of the largest group; alone: 1 */
	/* A pair that needs a person: 0, 0: none. */
	uint32_t refused_a, refused_b;
	bool needs_work;   /* there is something to compute: scans that the model does not have */
	drawn_site *drawn; /* NULL: there is no model, or why_not says why it cannot be drawn */
	char *why_not;
	/* What stands there from above, A8, north up; NULL without a model. */
	uint8_t *plan;
	double plan_west_m, plan_north_m, plan_m_per_px;
	/* Where to scan next; only when all scans are in the model, has_next false: nowhere that is worth it. */
	bool next_is_known, has_next;
	struct next_station next;
};
/* Errors are site_open's and the graph's. */
site_state *site_state_new(const char *folder, GError **error);
void site_state_free(site_state *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(site_state, site_state_free)

/* How the scans fit, in words; *ret_verdict becomes "good", "doubt", "bad" or NULL. Caller frees. */
char *site_state_words(const site_state *s, const char **ret_verdict);
/* Of one scan among the others. */
const char *site_state_scan_verdict(const site_state *s, uint32_t number);

#endif
