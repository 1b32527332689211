/* Text of data files made safe: UTF-8 without control characters. */
#ifndef BLVD_TOOLS_READ_TEXT_H
#define BLVD_TOOLS_READ_TEXT_H

#include <stdbool.h>
#include <stddef.h>

#include "tools/city/pool.h"

/* Bytes of the valid UTF-8 sequence at `text` (RFC 3629), or 0. */
size_t text_sequence(const char *text);

/* Valid UTF-8 and no control characters (C0, DEL, C1). */
bool text_is_clean(const char *text);

/* A copy in which bytes that are no UTF-8 are read as Latin-1, which is what they usually are, and control characters
 * are spaces. */
char *text_mend(struct pool *pool, const char *text);

#endif
