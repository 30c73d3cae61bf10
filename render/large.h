#ifndef RENDER_LARGE_H
#define RENDER_LARGE_H
/* Memory of many megabytes that is read here and there, on large pages where the system has them: processors remember where only so
 * many pages are. What is freed goes back to the system. Any thread. */
#include <glib.h>

/* Of any content. Like g_malloc it ends the program where there is none. */
void *large_new(size_t bytes);
void large_free(void *memory); /* NULL is fine */

/* So many bytes of it are one part, which begins where vectors and cache lines do. */
static inline size_t large_part(size_t bytes)
{
	return (bytes + 63) / 64 * 64;
}

/* The part from *at on, which moves behind it. */
static inline void *large_take(char **at, size_t bytes)
{
	void *ret = *at;
	*at += large_part(bytes);
	return ret;
}

#endif
