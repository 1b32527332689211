/*
 * Offline memory: a pool frees everything at once; ARRAY_PUSH grows an array by doubling. Out of memory ends the
 * program with a clear line: a bake has nothing better to do.
 */
#ifndef BLVD_TOOLS_CITY_POOL_H
#define BLVD_TOOLS_CITY_POOL_H

#include <stddef.h>
#include <stdlib.h>

struct pool {
	struct pool_block *blocks;
};

/* Zeroed, aligned for any type; valid until pool_finish. */
void *pool_alloc(struct pool *pool, size_t bytes);
void *pool_copy(struct pool *pool, const void *from, size_t bytes);
char *pool_string(struct pool *pool, const char *text);
void pool_finish(struct pool *pool);

#define POOL_ARRAY(pool, type, count) ((type *)pool_alloc((pool), sizeof(type) * (size_t)(count)))

/* An array is { T *items; size_t count, capacity; }, zeroed to start with; freed by ARRAY_FINISH. */
#define ARRAY(type)                                                                                                    \
	struct {                                                                                                           \
		type *items;                                                                                                   \
		size_t count, capacity;                                                                                        \
	}

void *array_grow(void *items, size_t *capacity, size_t needed, size_t item_bytes);

#define ARRAY_RESERVE(array, needed)                                                                                   \
	((void)((array)->capacity >= (needed) ||                                                                           \
			((array)->items = array_grow((array)->items, &(array)->capacity, (needed), sizeof(*(array)->items)))))
#define ARRAY_PUSH(array, ...)                                                                                         \
	(ARRAY_RESERVE((array), (array)->count + 1), (array)->items[(array)->count] = (__VA_ARGS__), (array)->count++)
#define ARRAY_FINISH(array) (array_free((array)->items), (array)->items = NULL, (array)->count = (array)->capacity = 0)

/* By qsort(), which wants no NULL: empty arrays have one. */
#define ARRAY_SORT(array, compare)                                                                                     \
	((array)->items ? qsort((array)->items, (array)->count, sizeof(*(array)->items), (compare)) : (void)0)

void array_free(void *items);

#endif
