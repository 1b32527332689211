/* Where the C library's blocks lie once the heap was prepared. */
#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/heap.h"

#define PIECE ((size_t)96 << 20)
#define GROWS ((size_t)1 << 20)
#define BLOCK ((size_t)40 << 20) /* the C library alone would map it on its own */

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__GLIBC__)
#define HAS_HEAP 0
#else
#define HAS_HEAP 1
#endif

/* Not every kernel has that much address space behind a program: user emulation of another processor has not. */
static bool can_grow_by(size_t bytes)
{
	if (sbrk((intptr_t)bytes) == (void *)-1)
		return false;
	sbrk(-(intptr_t)bytes);
	return true;
}

static void large_blocks_come_from_one_piece_and_are_used_again(void **state)
{
	struct heap_piece piece;
	(void)state;
	if (!HAS_HEAP || !can_grow_by(PIECE + 2 * GROWS))
		skip();
	heap_prepare(&piece, PIECE);
	volatile uint8_t *first_growth = malloc(GROWS);
	first_growth[0] = 1; /* or a compiler leaves it out */
	heap_large_pages(&piece, true);
	const uint8_t *from = piece.from, *end = sbrk(0);
	assert_true(end - from >= (ptrdiff_t)PIECE);
	for (int i = 0; i < 3; i++) {
		uint8_t *first = malloc(BLOCK), *second = malloc(BLOCK);
		assert_non_null(first);
		assert_non_null(second);
		assert_true(first >= from && first + BLOCK <= end);
		assert_true(second >= from && second + BLOCK <= end);
		memset(first, i, BLOCK);
		memset(second, i, BLOCK);
		free(first);
		free(second);
		assert_ptr_equal(sbrk(0), end); /* nothing was given back, nothing more was asked for */
	}
	heap_large_pages(&piece, false);
	free((void *)(uintptr_t)first_growth);
}

static void more_than_the_piece_is_had_too(void **state)
{
	(void)state;
	uint8_t *block = malloc(2 * PIECE);
	assert_non_null(block);
	block[0] = block[2 * PIECE - 1] = 1;
	free(block);
}

static void a_piece_that_is_too_large_leaves_the_heap_usable(void **state)
{
	struct heap_piece piece;
	(void)state;
	heap_prepare(&piece, SIZE_MAX);
	void *block = malloc(BLOCK);
	heap_large_pages(&piece, true);
	assert_non_null(block);
	free(block);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(large_blocks_come_from_one_piece_and_are_used_again),
		cmocka_unit_test(more_than_the_piece_is_had_too),
		cmocka_unit_test(a_piece_that_is_too_large_leaves_the_heap_usable),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
