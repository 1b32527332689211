#include "tools/drive/drive_arguments.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

struct geo_point argument_place(const char *text, struct argp_state *state)
{
	struct geo_point out;
	int used = 0;
	if (sscanf(text, "%lf,%lf%n", &out.lat_deg, &out.lon_deg, &used) != 2 || text[used] ||
		!(fabs(out.lat_deg) <= 90.0) || !(fabs(out.lon_deg) <= 360.0))
		argp_error(state, "'%s' is no LAT,LON in degrees", text);
	return out;
}

double argument_number(const char *text, double low, double high, struct argp_state *state)
{
	char *end;
	double value = strtod(text, &end);
	if (end == text || *end || !(value >= low && value <= high))
		argp_error(state, "'%s' is no number from %g to %g", text, low, high);
	return value;
}

uint64_t argument_seed(const char *text, struct argp_state *state)
{
	char *end;
	errno = 0;
	unsigned long long seed = strtoull(text, &end, 0);
	if (end == text || *end || errno || *text == '-')
		argp_error(state, "'%s' is no seed", text);
	return seed;
}
