#include "tools/measure/plot.h"

#include <math.h>

#define WIDTH 620.0
#define HEIGHT 340.0
#define LEFT 64.0
#define RIGHT 24.0
#define TOP 16.0
#define BOTTOM 48.0
#define STEPS 6 /* about so many marks on an axis */

const char *plot_colour(unsigned series)
{
	/* told apart by most who see few colours: Okabe and Ito's set */
	static const char *const colours[] = { "#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9",
		"#8c8c8c" };
	return colours[series % (sizeof(colours) / sizeof(colours[0]))];
}

void html_text(FILE *to, const char *text)
{
	for (; *text; text++) {
		if (*text == '<')
			fputs("&lt;", to);
		else if (*text == '>')
			fputs("&gt;", to);
		else if (*text == '&')
			fputs("&amp;", to);
		else
			fputc(*text, to);
	}
}

/* 1, 2 or 5 times a power of ten. */
static double step_of(double range)
{
	double rough = range / STEPS, power = pow(10.0, floor(log10(rough)));
	double digit = rough / power;
	return power * (digit <= 1.0 ? 1.0 : digit <= 2.0 ? 2.0 : digit <= 5.0 ? 5.0 : 10.0);
}

static void fit(double *min, double *max)
{
	*min = 0.0;
	if (!(*max > 0.0) || !isfinite(*max))
		*max = 1.0;
	double step = step_of(*max);
	*max = ceil(*max / step + 0.1) * step;
}

void plot_fit(struct plot *plot)
{
	fit(&plot->y_min, &plot->y_max);
	if (!plot->log_x) {
		fit(&plot->x_min, &plot->x_max);
		return;
	}
	if (!(plot->x_min > 0.0) || !(plot->x_max >= plot->x_min)) {
		plot->x_min = 1.0;
		plot->x_max = 10.0;
	}
	plot->x_min *= 0.7;
	plot->x_max *= 1.6;
}

static double place_x(const struct plot *plot, double x)
{
	double share = plot->log_x ? log(x / plot->x_min) / log(plot->x_max / plot->x_min)
							   : (x - plot->x_min) / (plot->x_max - plot->x_min);
	return LEFT + share * (WIDTH - LEFT - RIGHT);
}

static double place_y(const struct plot *plot, double y)
{
	double share = (y - plot->y_min) / (plot->y_max - plot->y_min);
	return HEIGHT - BOTTOM - share * (HEIGHT - TOP - BOTTOM);
}

static void mark_x(const struct plot *plot, double x)
{
	double at = place_x(plot, x);
	fprintf(plot->to, "<path class=\"grid\" d=\"M%.1f %.1fV%.1f\"/><text x=\"%.1f\" y=\"%.1f\" class=\"x\">%g</text>\n",
		at, TOP, HEIGHT - BOTTOM, at, HEIGHT - BOTTOM + 16.0, x);
}

static void mark_y(const struct plot *plot, double y)
{
	double at = place_y(plot, y);
	fprintf(plot->to, "<path class=\"grid\" d=\"M%.1f %.1fH%.1f\"/><text x=\"%.1f\" y=\"%.1f\" class=\"y\">%g</text>\n",
		LEFT, at, WIDTH - RIGHT, LEFT - 6.0, at + 4.0, y);
}

static void mark_log(const struct plot *plot)
{
	static const double digits[] = { 1.0, 2.0, 5.0, 3.0, 7.0 };
	size_t count = plot->x_max < 12.0 * plot->x_min ? 5 : 3;
	for (double power = pow(10.0, floor(log10(plot->x_min))); power <= plot->x_max; power *= 10.0)
		for (size_t i = 0; i < count; i++)
			if (digits[i] * power >= plot->x_min && digits[i] * power <= plot->x_max)
				mark_x(plot, digits[i] * power);
}

void plot_begin(const struct plot *plot)
{
	fprintf(plot->to, "<svg viewBox=\"0 0 %g %g\" width=\"%g\" height=\"%g\" role=\"img\">\n", WIDTH, HEIGHT, WIDTH,
		HEIGHT);
	double step = step_of(plot->y_max - plot->y_min);
	for (int i = 0; i * step <= plot->y_max * 1.0001; i++)
		mark_y(plot, i * step);
	if (plot->log_x)
		mark_log(plot);
	else
		for (int i = 0; i * step_of(plot->x_max) <= plot->x_max * 1.0001; i++)
			mark_x(plot, i * step_of(plot->x_max));
	fprintf(plot->to, "<text x=\"%.1f\" y=\"%.1f\" class=\"x\">%s</text>\n", (LEFT + WIDTH - RIGHT) / 2.0,
		HEIGHT - 10.0, plot->x_label);
	fprintf(plot->to, "<text transform=\"translate(14 %.1f) rotate(-90)\" class=\"x\">%s</text>\n",
		(TOP + HEIGHT - BOTTOM) / 2.0, plot->y_label);
}

void plot_dot(const struct plot *plot, double x, double y, unsigned series, bool filled, const char *name)
{
	if (!isfinite(x) || !isfinite(y) || (plot->log_x && !(x > 0.0)))
		return;
	double at_x = place_x(plot, x), at_y = place_y(plot, y);
	bool left = at_x > WIDTH - 110.0;
	fprintf(plot->to, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"5\" fill=\"%s\" stroke=\"%s\" stroke-width=\"2\"/>", at_x,
		at_y, filled ? plot_colour(series) : "#ffffff", plot_colour(series));
	fprintf(plot->to, "<text x=\"%.1f\" y=\"%.1f\" class=\"%s\">", at_x + (left ? -9.0 : 9.0),
		at_y - 6.0 - 13.0 * (series % 4), left ? "y" : "n"); /* one above the other where dots are close */
	html_text(plot->to, name);
	fputs("</text>\n", plot->to);
}

void plot_line(const struct plot *plot, const double *x, const double *y, size_t count, unsigned series, bool dashed)
{
	if (count < 2)
		return;
	fprintf(plot->to, "<polyline fill=\"none\" stroke=\"%s\"%s points=\"", plot_colour(series),
		dashed ? " stroke-dasharray=\"5 4\"" : "");
	for (size_t i = 0; i < count; i++)
		fprintf(plot->to, "%.1f,%.1f ", place_x(plot, x[i]), place_y(plot, y[i]));
	fputs("\"/>\n", plot->to);
}

void plot_end(const struct plot *plot)
{
	fputs("</svg>\n", plot->to);
}
