#include "render/large.h"
#include <sys/mman.h>

#define PAGE_BYTES ((size_t)2 << 20)

void *large_new(size_t bytes)
{
	size_t whole = (bytes + PAGE_BYTES - 1) / PAGE_BYTES * PAGE_BYTES;
	void *ret = g_aligned_alloc(1, whole, PAGE_BYTES);
	madvise(ret, whole, MADV_HUGEPAGE); /* or small ones */
	return ret;
}

void large_free(void *memory)
{
	g_aligned_free(memory);
}
