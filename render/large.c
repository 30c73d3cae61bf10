#include "render/large.h"
#include <errno.h>
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#define PAGE_BYTES ((size_t)2 << 20)
/* What is left at the end has a large page too when it fills so much of it, else small ones. */
#define FILLED_LEAST (PAGE_BYTES * 3 / 4)

static size_t large_bytes(size_t bytes)
{
	return (bytes + PAGE_BYTES - FILLED_LEAST) / PAGE_BYTES * PAGE_BYTES;
}

#if defined __SANITIZE_ADDRESS__

/* It knows the ends of what it has given out itself. */
static void *take(size_t bytes)
{
	return g_aligned_alloc(1, bytes, PAGE_BYTES);
}

void large_free(void *memory)
{
	g_aligned_free(memory);
}

#else

static size_t small_page(void)
{
	return (size_t)sysconf(_SC_PAGESIZE);
}

/* From the system itself. malloc() keeps what it has once had for what comes next, as commands are told to by large-pages.h: a third of
 * what a program held that drew in some styles by turns. A small page before the memory knows how much it is. */
static void *take(size_t bytes)
{
	size_t small = small_page(), whole = (bytes + small - 1) / small * small,
	       room = small + PAGE_BYTES + whole;
	char *all = mmap(NULL, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	if (all == MAP_FAILED)
		g_error("%zu bytes of memory: %s", bytes, g_strerror(errno));
	char *ret = all + small;
	ret += (PAGE_BYTES - (uintptr_t)ret % PAGE_BYTES) % PAGE_BYTES;
	char *from = ret - small, *end = ret + whole;
	if (from > all)
		munmap(all, (size_t)(from - all));
	if (end < all + room)
		munmap(end, (size_t)(all + room - end));
	*(size_t *)(void *)from = small + whole;
	return ret;
}

void large_free(void *memory)
{
	if (!memory)
		return;
	char *from = (char *)memory - small_page();
	munmap(from, *(size_t *)(void *)from);
}

#endif

void *large_new(size_t bytes)
{
	size_t large = large_bytes(bytes);
	void *ret = take(MAX(bytes, large));
	if (large)
		madvise(ret, large, MADV_HUGEPAGE); /* or small ones, where there are none */
	return ret;
}
