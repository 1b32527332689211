/* The STRS section being built: each string once, in the order of first use. */
#ifndef BLVD_TOOLS_BAKE_STRINGS_H
#define BLVD_TOOLS_BAKE_STRINGS_H

#include <stdint.h>

#include "tools/city/pool.h"

struct string_table {
	ARRAY(char) bytes;     /* NUL-terminated strings; starts with the empty one */
	ARRAY(uint32_t) slots; /* open-addressed hash of offsets + 1; count is unused */
	uint32_t used;
};

/* Offset of `text` in `bytes`; NULL and "" are 0. */
uint32_t strings_intern(struct string_table *table, const char *text);
void strings_finish(struct string_table *table);

#endif
