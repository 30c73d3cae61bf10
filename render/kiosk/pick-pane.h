#ifndef RENDER_KIOSK_PICK_PANE_H
#define RENDER_KIOSK_PICK_PANE_H
/* A panorama to pick cells in: one finger shifts it round and round, two zoom; a tap sets a mark, and a finger that begins on a mark moves
 * it, slower than the finger goes, while a loupe shows what is under it. Cells are columns from the left and rows from the top of the
 * picture. Main thread. */
#include "render/kiosk/kit.h"
#include <stdint.h>

struct pick_mark {
	uint32_t column, row, number; /* number: what it shows, from 1 */
	bool selected, alone;         /* alone: its other half is not set yet */
	bool bad;
};
struct pick_pane_watcher {
	/* NULL marks are never told of. */
	void (*tapped)(uint32_t column, uint32_t row, gpointer user_data);
	void (*mark_tapped)(uint32_t number, gpointer user_data);
	/* last: the finger has left. */
	void (*mark_moved)(
		uint32_t number, uint32_t column, uint32_t row, bool last, gpointer user_data);
	gpointer user_data;
};

GtkWidget *pick_pane_new(
	const char *name, const char *label, const struct pick_pane_watcher *watcher);
/* rgb: 3 bytes a cell, copied. */
void pick_pane_set_picture(GtkWidget *pane, const uint8_t *rgb, uint32_t columns, uint32_t rows);
void pick_pane_set_marks(GtkWidget *pane, const struct pick_mark *marks, guint count);
/* No callback comes any more. */
void pick_pane_forget(GtkWidget *pane);

#endif
