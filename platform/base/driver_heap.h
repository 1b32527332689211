/* The heap that libraries use, of which a GL driver that draws on the CPU takes hundreds of MiB within the first tenth
 * of a second. */
#ifndef BLVD_PLATFORM_BASE_DRIVER_HEAP_H
#define BLVD_PLATFORM_BASE_DRIVER_HEAP_H

#include <stddef.h>

/* From here on the C library's heap is one range of at least `bytes` of address space, in large pages where the kernel
 * gives them when asked: a page fault for each 4 KiB cost a third of the start. What is freed is used again, not
 * returned. Before the first library that allocates much; main thread. Cannot fail: without it all is as it was. */
void driver_heap_reserve(size_t bytes);

#endif
