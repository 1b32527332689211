/* Plots as SVG inside a page: axes, dots with names, lines. */
#ifndef BLVD_TOOLS_MEASURE_PLOT_H
#define BLVD_TOOLS_MEASURE_PLOT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

struct plot {
	FILE *to;
	const char *x_label, *y_label;
	double x_min, x_max, y_min, y_max; /* plot_fit() makes them round and not empty */
	bool log_x;                        /* x_min > 0 */
};

/* Colour of a series, "#rrggbb"; from the eighth on they repeat. */
const char *plot_colour(unsigned series);

/* Widens the ranges to round numbers. Without a logarithm they start at 0. */
void plot_fit(struct plot *plot);
void plot_begin(const struct plot *plot);
void plot_dot(const struct plot *plot, double x, double y, unsigned series, bool filled, const char *name);
void plot_line(const struct plot *plot, const double *x, const double *y, size_t count, unsigned series, bool dashed);
void plot_end(const struct plot *plot);

/* Text with what HTML needs escaped. */
void html_text(FILE *to, const char *text);

#endif
