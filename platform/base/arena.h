/*
 * Linear memory arena over memory that the caller reserved. Nothing is freed one by one: a whole
 * arena is reset, or rolled back to a mark. Not thread safe; one arena belongs to one thread.
 */
#ifndef BLVD_PLATFORM_BASE_ARENA_H
#define BLVD_PLATFORM_BASE_ARENA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct arena {
	const char *name;  /* for logs and stats; borrowed */
	uint8_t *base;     /* borrowed from the caller of arena_init */
	size_t size;       /* bytes at base */
	size_t used;       /* bytes handed out, padding included */
	size_t high_water; /* largest value `used` ever had */
	size_t failed;     /* requests that did not fit */
	bool sealed;       /* nothing should ask any more */
	size_t late;       /* requests after arena_seal() */
};

void arena_init(struct arena *arena, const char *name, void *base, size_t size);

/* Zeroed memory, aligned to `align` (a power of two), or NULL when the arena is full. */
void *arena_alloc(struct arena *arena, size_t size, size_t align);

/* Cuts `size` bytes off `parent` and makes them an arena of their own. Returns 0 or -ENOMEM. */
int arena_carve(struct arena *parent, struct arena *child, const char *name, size_t size);

/* From here on every request is counted in `late`; it is still served. For the end of start-up. */
void arena_seal(struct arena *arena);

size_t arena_mark(const struct arena *arena);
void arena_release(struct arena *arena, size_t mark);

/* Typed array of `count` zeroed elements, or NULL. */
#define ARENA_ARRAY(arena, type, count) ((type *)arena_alloc((arena), sizeof(type) * (size_t)(count), _Alignof(type)))

#endif
