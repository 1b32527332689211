/* profiles/sim.ini, compiled in. */
#ifndef BLVD_BOARD_PROFILE_SIM_H
#define BLVD_BOARD_PROFILE_SIM_H

#include <stddef.h>

extern const char profile_sim_text[]; /* NUL-terminated */
extern const size_t profile_sim_size; /* without the NUL */

#endif
