/* Bump allocation; every call is constant time but for the zeroing. */
#include "platform/base/arena.h"

#include <assert.h>
#include <errno.h>
#include <string.h>

void arena_init(struct arena *arena, const char *name, void *base, size_t size)
{
	*arena = (struct arena){ .name = name, .base = base, .size = size };
}

void *arena_alloc(struct arena *arena, size_t size, size_t align)
{
	assert(align != 0 && (align & (align - 1)) == 0);
	if (arena->sealed)
		arena->late++;
	uintptr_t at = (uintptr_t)arena->base + arena->used;
	size_t pad = (size_t)(-at & (align - 1));
	size_t left = arena->size - arena->used;
	if (pad > left || size > left - pad) {
		arena->failed++;
		return NULL;
	}
	uint8_t *out = arena->base + arena->used + pad;
	arena->used += pad + size;
	if (arena->used > arena->high_water)
		arena->high_water = arena->used;
	return memset(out, 0, size);
}

int arena_carve(struct arena *parent, struct arena *child, const char *name, size_t size)
{
	void *base = arena_alloc(parent, size, 64);
	if (!base)
		return -ENOMEM;
	arena_init(child, name, base, size);
	return 0;
}

void arena_seal(struct arena *arena)
{
	arena->sealed = true;
}

size_t arena_mark(const struct arena *arena)
{
	return arena->used;
}

void arena_release(struct arena *arena, size_t mark)
{
	assert(mark <= arena->used);
	arena->used = mark;
}
