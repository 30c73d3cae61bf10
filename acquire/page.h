#ifndef ACQUIRE_PAGE_H
#define ACQUIRE_PAGE_H
/* One HTML page that shows a site's panoramas: no script, no network, pictures beside it. */
#include "acquire/panorama.h"

typedef struct page page;

page *page_new(const char *title);
void page_free(page *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(page, page_free)

void page_begin_scan(page *p, uint32_t number, const panorama *scan);
/* name is the picture's file, beside the page. */
void page_add_picture(page *p, const char *caption, const char *name);
uint32_t page_scans(const page *p);
bool page_save(const page *p, const char *path, GError **error);

#endif
