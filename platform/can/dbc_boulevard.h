/* The virtual car's signal definitions, board/profiles/boulevard.dbc, compiled in: `blvd drive` writes by them and
 * `boulevard` reads by them without any file. */
#ifndef BLVD_PLATFORM_CAN_DBC_BOULEVARD_H
#define BLVD_PLATFORM_CAN_DBC_BOULEVARD_H

#include <stddef.h>

extern const char dbc_boulevard_text[]; /* NUL-terminated */
extern const size_t dbc_boulevard_size; /* without the NUL */

#endif
