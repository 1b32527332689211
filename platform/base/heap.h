/*
 * The C library's heap, which is not ours: GL drivers take from it, and one that draws on the CPU keeps every texture
 * and buffer there. Nothing here takes memory.
 */
#ifndef BLVD_PLATFORM_BASE_HEAP_H
#define BLVD_PLATFORM_BASE_HEAP_H

#include <stdbool.h>
#include <stddef.h>

struct heap_piece {
	void *from; /* where the heap ended */
};

/*
 * Before the driver is loaded, by the main thread while there is no other: when the heap grows next it grows by
 * `bytes`, in one piece of address space, and from then on large blocks lie in it too, and what is freed stays there
 * for the next one.
 */
void heap_prepare(struct heap_piece *piece, size_t bytes);

/*
 * Asks the kernel for large pages behind what of the piece is used from now on, or no longer: while a start fills the
 * piece they spare thousands of page faults, but a drive that touches one more byte shall not take 2 MiB more. A hint:
 * where it is not taken, nothing changes. A zeroed piece does nothing.
 */
void heap_large_pages(const struct heap_piece *piece, bool wanted);

#endif
