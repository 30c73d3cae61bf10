#ifndef RENDER_KIOSK_ALIGN_PICKS_H
#define RENDER_KIOSK_ALIGN_PICKS_H
/* Pairs of cells that a person picked in two scans: side 0 and 1. What was picked in one alone waits for the other. No GTK. */
#include "process/pick-file.h"

#define ALIGN_PICKS_LEAST 3

struct align_pick {
	bool has[2];
	uint32_t column[2], row[2];
};

typedef struct align_picks align_picks;
struct align_picks {
	GArray *pairs; /* of struct align_pick */
};
align_picks *align_picks_new(void);
align_picks *align_picks_copy(const align_picks *p);
void align_picks_free(align_picks *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(align_picks, align_picks_free)

/* The nearest cell with a point, within a few: edges of things are often just beside a hole. */
bool align_picks_find(const range_grid *g, uint32_t *column, uint32_t *row);
/* A cell on this side: of the first pair that lacks it there, or of a new one. Which pair it became. */
guint align_picks_add(align_picks *p, int side, uint32_t column, uint32_t row);
void align_picks_move(align_picks *p, guint pair, int side, uint32_t column, uint32_t row);
void align_picks_remove(align_picks *p, guint pair);
/* Of pairs with both. */
guint align_picks_whole(const align_picks *p);

/* How well the whole pairs agree: ret_residual_m of each pair (below 0: it is not whole), ret_blunder likewise; both have a place for every
 * pair. false: too few, or they tell nothing: PICKS_ERROR, or a cell without a point. */
bool align_picks_fit(const align_picks *p, const scan_data *a, const scan_data *b,
	double *ret_residual_m, bool *ret_blunder, GError **error);

/* As pick-file.h has it. A file that is not there is no pairs. */
bool align_picks_save(const align_picks *p, const char *path, GError **error);
align_picks *align_picks_load(const char *path);

#endif
