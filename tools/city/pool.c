#include "tools/city/pool.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BLOCK_BYTES ((size_t)1 << 20)

struct pool_block {
	struct pool_block *next;
	size_t used, size;
	max_align_t bytes[];
};

static void *or_die(void *memory, size_t bytes)
{
	if (!memory) {
		fprintf(stderr, "blvd: error: out of memory asking for %zu bytes\n", bytes);
		exit(1);
	}
	return memory;
}

static struct pool_block *add_block(struct pool *pool, size_t size)
{
	size_t bytes = sizeof(struct pool_block) + size;
	struct pool_block *block = or_die(calloc(1, bytes), bytes);
	block->size = size;
	/* A block of its own for something large goes behind the current one, which may still have room. */
	if (size > BLOCK_BYTES && pool->blocks) {
		block->next = pool->blocks->next;
		pool->blocks->next = block;
	} else {
		block->next = pool->blocks;
		pool->blocks = block;
	}
	return block;
}

void *pool_alloc(struct pool *pool, size_t bytes)
{
	size_t size = (bytes + _Alignof(max_align_t) - 1) & ~(_Alignof(max_align_t) - 1);
	struct pool_block *block = pool->blocks;
	if (!block || block->size - block->used < size)
		block = add_block(pool, size > BLOCK_BYTES ? size : BLOCK_BYTES);
	void *out = (unsigned char *)block->bytes + block->used;
	block->used += size;
	return out;
}

void *pool_copy(struct pool *pool, const void *from, size_t bytes)
{
	void *out = pool_alloc(pool, bytes);
	if (bytes)
		memcpy(out, from, bytes);
	return out;
}

char *pool_string(struct pool *pool, const char *text)
{
	return pool_copy(pool, text, strlen(text) + 1);
}

void pool_finish(struct pool *pool)
{
	for (struct pool_block *block = pool->blocks, *next; block; block = next) {
		next = block->next;
		free(block);
	}
	pool->blocks = NULL;
}

void *array_grow(void *items, size_t *capacity, size_t needed, size_t item_bytes)
{
	size_t wanted = *capacity ? *capacity * 2 : 16;
	if (wanted < needed)
		wanted = needed;
	*capacity = wanted;
	return or_die(realloc(items, wanted * item_bytes), wanted * item_bytes);
}

void array_free(void *items)
{
	free(items);
}
