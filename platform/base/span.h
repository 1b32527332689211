/* A borrowed run of bytes. The owner is whoever made it; a span never frees. */
#ifndef BLVD_PLATFORM_BASE_SPAN_H
#define BLVD_PLATFORM_BASE_SPAN_H

#include <stddef.h>
#include <stdint.h>

struct span {
	const uint8_t *data;
	size_t size;
};

#endif
