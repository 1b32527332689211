#include "platform/base/driver_heap.h"

#include <limits.h>
#include <malloc.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <unistd.h>

#define LARGE_PAGE ((uintptr_t)2 << 20)

void driver_heap_reserve(size_t bytes)
{
#ifdef __GLIBC__
	static void *first; /* kept: it is what makes the heap grow */
	if (first || bytes > INT_MAX)
		return;
	mallopt(M_MMAP_MAX, 0);
	mallopt(M_TRIM_THRESHOLD, INT_MAX);
	mallopt(M_TOP_PAD, (int)bytes);
	if (posix_memalign(&first, 64, 256 << 10) != 0)
		return;
	uintptr_t from = ((uintptr_t)first + LARGE_PAGE - 1) & ~(LARGE_PAGE - 1), to = (uintptr_t)sbrk(0);
	if (to > from && to - from <= (uintptr_t)bytes * 2)
		madvise((void *)from, to - from, MADV_HUGEPAGE); /* refused where the kernel has no such pages */
	mallopt(M_TOP_PAD, (int)LARGE_PAGE);
#else
	(void)bytes;
#endif
}
