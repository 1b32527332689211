/*
 * A start on llvmpipe fills 100 to 350 MiB of the heap: by pages of 4 KiB that was a third of its processor time. Cost:
 * three system calls.
 */
#include "platform/base/heap.h"

#include <limits.h>
#include <malloc.h>
#include <stdint.h>
#include <sys/mman.h>
#include <unistd.h>

#define LARGE_PAGE ((size_t)2 << 20)
#define LARGEST_BLOCK (1 << 30) /* larger ones are mapped on their own, as ever */

/* With a sanitizer the heap is the sanitizer's. */
#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define HEAP_IS_KNOWN 1
#else
#define HEAP_IS_KNOWN 0
#endif

void heap_prepare(struct heap_piece *piece, size_t bytes)
{
	*piece = (struct heap_piece){ 0 };
#if HEAP_IS_KNOWN
	piece->from = sbrk(0);
	mallopt(M_MMAP_THRESHOLD, LARGEST_BLOCK);
	mallopt(M_TRIM_THRESHOLD, INT_MAX);
	mallopt(M_TOP_PAD, bytes < INT_MAX ? (int)bytes : INT_MAX);
#else
	(void)bytes;
#endif
}

void heap_large_pages(const struct heap_piece *piece, bool wanted)
{
	if (!piece->from)
		return;
	uint8_t *from = piece->from, *end = sbrk(0);
	size_t skipped = -(uintptr_t)from & (LARGE_PAGE - 1);
	if (end > from && (size_t)(end - from) > skipped)
		madvise(from + skipped, (size_t)(end - from) - skipped, wanted ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
}
