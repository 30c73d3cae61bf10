#ifndef RENDER_SWEEP_SHEET_H
#define RENDER_SWEEP_SHEET_H
/* A contact sheet: a title, pictures side by side, and below each what it is. One thread. */
#include "render/frame.h"

#define SHEET_CELL_MOST 640u /* pixels: larger pictures are made smaller on it */
#define SHEET_MANY_MOST 320u /* where there are many of them, as of all styles */

typedef struct sheet sheet;
/* For so many cells of some pictures above one another, all of one size. */
sheet *sheet_new(const char *title, const char *below, guint cells, guint rows, uint32_t width,
	uint32_t height);
void sheet_free(sheet *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(sheet, sheet_free)

void sheet_put(sheet *s, guint cell, guint row, const struct picture_buffer *picture);
void sheet_label(sheet *s, guint cell, const char *text);
bool sheet_save(sheet *s, const char *path, GError **error);

#endif
