#ifndef RENDER_KIOSK_ARTIST_H
#define RENDER_KIOSK_ARTIST_H
/* Draws a site on a thread of its own, so that touch never waits for it. Of all that was wished for meanwhile only the last is drawn:
 * while the view moves as small as this machine needs to keep up, then whole, then finer and finer from views that differ by parts
 * of a pixel, then the small pictures of other styles. A new wish stops whatever is being drawn. Where a drawing changes with time, a
 * still view goes on instead, once the small pictures are there: as large as this machine needs to keep up.
 *
 * All functions and callbacks are of the thread that made it, which runs a main loop; after artist_free no callback comes. */
#include "render/painter.h"

/* Pictures that are added at most while nothing moves. */
#define ARTIST_PICTURES 16

struct artist_picture {
	GBytes *bgrx; /* rows of 4 * width bytes: blue, green, red, 255 */
	uint32_t width, height;
	struct camera camera; /* of the wish that it answers, of the size that was wished for */
	uint32_t pictures;    /* that it is the mean of; 0: a smaller one of a moving view */
	double seconds;       /* that drawing took */
	int64_t wished_us;    /* when it was wished for, by g_get_monotonic_time */
};
struct artist_watcher {
	void (*picture)(const struct artist_picture *p, gpointer user_data);
	/* The n-th of artist_set_small. */
	void (*small)(uint32_t n, const struct artist_picture *p, gpointer user_data);
	void (*failed)(const char *sentence, gpointer user_data);
	gpointer user_data;
};

typedef struct artist artist;
/* The scene must live until artist_free. Of one with a pager it draws what is there, and a still view again while points come to it. */
artist *artist_new(const scene *s, enum backend_wish wish, const struct artist_watcher *watcher);
/* Waits for the thread, which stops at once. NULL is fine. */
void artist_free(artist *a);

/* What is drawn from now on; takes d. */
void artist_set_drawing(artist *a, drawing *d);
/* Another light and focus than that drawing has, until there is another drawing. */
void artist_set_accents(
	artist *a, const struct style_light *light, const struct style_focus *focus);
/* Drawings that are drawn small whenever a still view is done; takes drawings (of drawing, with a free function). NULL: none. */
void artist_set_small(artist *a, GPtrArray *drawings, uint32_t width, uint32_t height);
/* From where; moving: more such will follow at once. */
void artist_look(artist *a, const struct camera *c, bool moving);
/* Painter's line on who draws; NULL until the first picture. Valid until artist_free. */
const char *artist_why(const artist *a);

#endif
