/* The smaller and the larger of two numbers, of which none is NaN: without the care that fmin() and fmax() take. */
#ifndef BLVD_TOOLS_IMPOSTOR_EXTREMES_H
#define BLVD_TOOLS_IMPOSTOR_EXTREMES_H

static inline double smaller(double a, double b)
{
	return a < b ? a : b;
}
static inline double larger(double a, double b)
{
	return a > b ? a : b;
}

#endif
