#include "render/large.h"
#include <sys/mman.h>
#if defined __GLIBC__
#include <malloc.h>
#endif

#define PAGE_BYTES ((size_t)2 << 20)
/* What is left at the end has a large page too when it fills so much of it, else small ones. */
#define FILLED_LEAST (PAGE_BYTES * 3 / 4)

/* What is as large goes back to the system when it is freed. glibc keeps ever larger pieces, in between which it frees nothing: a third
 * of what a program held that drew in some styles by turns. */
static void give_back(void)
{
#if defined __GLIBC__
	static gsize done;
	if (g_once_init_enter(&done)) {
		mallopt(M_MMAP_THRESHOLD, PAGE_BYTES);
		g_once_init_leave(&done, 1);
	}
#endif
}

void *large_new(size_t bytes)
{
	give_back();
	size_t large = (bytes + PAGE_BYTES - FILLED_LEAST) / PAGE_BYTES * PAGE_BYTES;
	void *ret = g_aligned_alloc(1, MAX(bytes, large), PAGE_BYTES);
	if (large)
		madvise(ret, large, MADV_HUGEPAGE); /* or small ones, where there are none */
	return ret;
}

void large_free(void *memory)
{
	g_aligned_free(memory);
}
