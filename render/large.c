#include "render/large.h"
#include <sys/mman.h>

#define PAGE_BYTES ((size_t)2 << 20)
/* What is left at the end has a large page too when it fills so much of it, else small ones. */
#define FILLED_LEAST (PAGE_BYTES * 3 / 4)

void *large_new(size_t bytes)
{
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
