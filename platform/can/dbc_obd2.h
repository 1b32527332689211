/* Signal definitions of OBD-II answers, board/profiles/obd2.dbc, compiled in. */
#ifndef BLVD_PLATFORM_CAN_DBC_OBD2_H
#define BLVD_PLATFORM_CAN_DBC_OBD2_H

#include <stddef.h>

extern const char dbc_obd2_text[]; /* NUL-terminated */
extern const size_t dbc_obd2_size; /* without the NUL */

#endif
