/* Words of a command line that `blvd drive` and `blvd sim` read alike. What is wrong ends the program by argp_error().
 */
#ifndef BLVD_TOOLS_DRIVE_DRIVE_ARGUMENTS_H
#define BLVD_TOOLS_DRIVE_DRIVE_ARGUMENTS_H

#include <argp.h>
#include <stdint.h>

#include "platform/base/geo.h"

/* LAT,LON in degrees. */
struct geo_point argument_place(const char *text, struct argp_state *state);
/* From `low` to `high`, both included. */
double argument_number(const char *text, double low, double high, struct argp_state *state);
/* Not negative; decimal, or hexadecimal or octal as C writes them. */
uint64_t argument_seed(const char *text, struct argp_state *state);

#endif
