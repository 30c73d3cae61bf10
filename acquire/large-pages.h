#ifndef ACQUIRE_LARGE_PAGES_H
#define ACQUIRE_LARGE_PAGES_H
/* For the environment of programs that compute and end. Grids and models are tens of megabytes each, and glibc takes each anew from
 * the kernel, a fault for every 4 KiB, and gives it back: a quarter of the time of pleinair-process. So: large pages where the kernel
 * has them to give (madvise), and what was freed is kept for what comes next, also on another thread. It is read before main(), by
 * ld.so alone (glibc's manual, "Memory Allocation Tunables"). Not for programs that run all day: they would never give anything back. */
#define LARGE_PAGES_VARIABLE "GLIBC_TUNABLES"
#define LARGE_PAGES_VALUE                                                                          \
	"glibc.malloc.hugetlb=1:glibc.malloc.arena_max=2:"                                         \
	"glibc.malloc.mmap_threshold=4294967296:"                                                  \
	"glibc.malloc.trim_threshold=4294967296:glibc.malloc.top_pad=67108864"

#endif
