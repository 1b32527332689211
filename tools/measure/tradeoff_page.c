/* The page: one HTML file with plots inside it, and pictures beside it. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <string.h>
#include <unistd.h>

#include "tools/measure/plot.h"
#include "tools/measure/tradeoff.h"

static const char style[] =
	"body{font:15px/1.5 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 "
	"1rem;color:#111;background:#fff}"
	"table{border-collapse:collapse;margin:1rem 0;font-variant-numeric:tabular-nums}"
	"td,th{border-bottom:1px solid #ccc;padding:.25rem .6rem;text-align:right}"
	"td:first-child,th:first-child,.t td{text-align:left}"
	"svg{font:12px system-ui,sans-serif;margin:.5rem 1rem .5rem 0}svg .grid{stroke:#ddd}svg .x{text-anchor:middle}"
	"svg .y{text-anchor:end}figure{display:inline-block;margin:.4rem;width:23rem;vertical-align:top}"
	"figure img{width:100%}figcaption{font-size:13px}code{background:#f2f2f2;padding:.1rem .3rem}";

/* Series are told apart by the order in which representations first come. */
static unsigned series_of(const struct tradeoff *tradeoff, const char *name)
{
	const struct trial_result *trial = &tradeoff->runs.items[0].trial;
	for (uint32_t i = 0; i < trial->count; i++)
		if (!strcmp(trial->entrants[i].name, name))
			return i;
	return trial->count;
}

static bool is_alone(const struct tradeoff *tradeoff, const struct setting *setting)
{
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *other = &tradeoff->settings.items[i];
		if (other != setting && !strcmp(other->name, setting->name))
			return false;
	}
	return true;
}

static const char *name_of(const struct tradeoff *tradeoff, const struct setting *setting, char out[48])
{
	if (is_alone(tradeoff, setting))
		snprintf(out, 48, "%s", setting->name);
	else
		snprintf(out, 48, "%s, tau %g", setting->name, setting->tau_px);
	return out;
}

static void write_judged(const struct tradeoff *tradeoff, FILE *to)
{
	struct judged_row rows[JUDGED_ROWS_MAX];
	unsigned count = tradeoff_judge(tradeoff, rows);
	fputs("<h2>What was asked</h2>\n<table class=\"t\"><tr><th>what<th>[S97]<th>asked<th>measured</tr>\n", to);
	for (unsigned i = 0; i < count; i++) {
		const char *cells[4] = { rows[i].what, rows[i].published, rows[i].asked, rows[i].measured };
		fputs("<tr>", to);
		for (int k = 0; k < 4; k++) {
			fputs("<td>", to);
			html_text(to, cells[k]);
		}
		fputs("</tr>\n", to);
	}
	fputs("</table>\n", to);
}

static void write_settings(const struct tradeoff *tradeoff, FILE *to)
{
	char name[48];
	fputs(
		"<h2>Settings</h2>\n<table><tr><th>setting<th>median "
		"ms<th>p99<th>speed-up<th>triangles<th>draws<th>MiB<th>first "
		"frame ms<th>FLIP<th>worst<th>SSIM<th>PSNR dB<th>precision<th>recall<th>within 2<th>displaced &le; 1 px<th>not "
		"found<th>uncovered, worst<th>cracks</tr>\n",
		to);
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *s = &tradeoff->settings.items[i];
		fprintf(to,
			"<tr><td>%s%s%s<td>%.1f<td>%.1f<td>%.2fx<td>%.0f<td>%.0f<td>%.1f<td>%.0f<td>%.4f<td>%.4f<td>%.4f<td>%.1f<"
			"td>%."
			"3f<td>%.3f<td>%.3f<td>%.3f %%<td>%.3f %%<td>%.4f %%<td>%llu</tr>\n",
			s->pareto ? "<b>" : "", name_of(tradeoff, s, name), s->pareto ? "</b>" : "", s->cpu_ms.median,
			s->cpu_ms.p99, s->speed_up, s->triangles.median, s->draws.median, (double)s->resident_bytes / 1048576.0,
			s->first_frame_ms, s->flip, s->flip_worst, s->ssim, s->psnr_db, s->precision, s->recall, s->recall_2,
			100.0 * displacement_share(&s->displacement, 1.0), 100.0 * displacement_share_lost(&s->displacement),
			100.0 * s->uncovered_worst, (unsigned long long)s->cracks);
	}
	fputs(
		"</table>\n<p>Bold: on the Pareto front; nothing else is as fast with less FLIP. Times are CPU time of all "
		"threads, "
		"so that other work on the machine counts little. Precision and recall are of equal pixels, and recall of such "
		"within 2/255. PSNR 99 stands for equal pictures.</p>\n",
		to);
}

static double cost_ms(const struct setting *s)
{
	return s->cpu_ms.median;
}
static double cost_mib(const struct setting *s)
{
	return (double)s->resident_bytes / 1048576.0;
}
static double error_flip(const struct setting *s)
{
	return s->flip;
}
static double error_displaced(const struct setting *s)
{
	return 100.0 - 100.0 * displacement_share(&s->displacement, 1.0);
}

struct axes {
	const char *title, *x_label, *y_label;
	double (*x)(const struct setting *s);
	double (*y)(const struct setting *s);
	bool front;
};

/* The front's settings from the fastest on. */
static void draw_front(const struct tradeoff *tradeoff, const struct plot *plot, const struct axes *axes)
{
	ARRAY(double) x = { 0 }, y = { 0 };
	for (double last = -INFINITY;;) {
		const struct setting *next = NULL;
		for (size_t i = 0; i < tradeoff->settings.count; i++) {
			const struct setting *s = &tradeoff->settings.items[i];
			if (s->pareto && axes->x(s) > last && (!next || axes->x(s) < axes->x(next)))
				next = s;
		}
		if (!next)
			break;
		last = axes->x(next);
		ARRAY_PUSH(&x, last);
		ARRAY_PUSH(&y, axes->y(next));
	}
	plot_line(plot, x.items, y.items, x.count, 7, true);
	ARRAY_FINISH(&x);
	ARRAY_FINISH(&y);
}

static void write_scatter(const struct tradeoff *tradeoff, FILE *to, const struct axes *axes)
{
	struct plot plot = {
		.to = to, .x_label = axes->x_label, .y_label = axes->y_label, .log_x = true, .x_min = INFINITY
	};
	char name[48];
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *s = &tradeoff->settings.items[i];
		plot.x_min = fmin(plot.x_min, axes->x(s));
		plot.x_max = fmax(plot.x_max, axes->x(s));
		plot.y_max = fmax(plot.y_max, axes->y(s));
	}
	plot_fit(&plot);
	fprintf(to, "<figure style=\"width:640px\"><figcaption>%s</figcaption>\n", axes->title);
	plot_begin(&plot);
	if (axes->front)
		draw_front(tradeoff, &plot, axes);
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *s = &tradeoff->settings.items[i];
		plot_dot(&plot, axes->x(s), axes->y(s), series_of(tradeoff, s->name), s->pareto, name_of(tradeoff, s, name));
	}
	plot_end(&plot);
	fputs("</figure>\n", to);
}

static double row_ms(const struct trial_row *row)
{
	return row->cpu_ms;
}
static double row_popping(const struct trial_row *row)
{
	return row->popping.rms;
}

struct series {
	const char *title, *y_label;
	double (*value)(const struct trial_row *row);
	uint32_t first; /* representation */
};

/* The first run, frame by frame. */
static void write_frames(const struct tradeoff *tradeoff, FILE *to, const struct series *series)
{
	const struct trial_result *trial = &tradeoff->runs.items[0].trial;
	struct plot plot = { .to = to, .x_label = "frame", .y_label = series->y_label };
	for (uint32_t k = series->first; k < trial->count; k++) {
		for (size_t i = 0; i < trial->rows[k].rows.count; i++) {
			plot.y_max = fmax(plot.y_max, series->value(&trial->rows[k].rows.items[i]));
			plot.x_max = fmax(plot.x_max, (double)i);
		}
	}
	plot_fit(&plot);
	fprintf(to, "<figure style=\"width:640px\"><figcaption>%s, tau %g:", series->title, tradeoff->runs.items[0].tau_px);
	for (uint32_t k = series->first; k < trial->count; k++)
		fprintf(to, " <span style=\"color:%s\">&#9632;</span> %s", plot_colour(k), trial->entrants[k].name);
	fputs("</figcaption>\n", to);
	plot_begin(&plot);
	for (uint32_t k = series->first; k < trial->count; k++) {
		ARRAY(double) x = { 0 }, y = { 0 };
		for (size_t i = 0; i < trial->rows[k].rows.count; i++) {
			ARRAY_PUSH(&x, trial->rows[k].rows.items[i].frame);
			ARRAY_PUSH(&y, series->value(&trial->rows[k].rows.items[i]));
		}
		plot_line(&plot, x.items, y.items, x.count, k, false);
		ARRAY_FINISH(&x);
		ARRAY_FINISH(&y);
	}
	plot_end(&plot);
	fputs("</figure>\n", to);
}

static void write_plots(const struct tradeoff *tradeoff, FILE *to)
{
	static const struct axes all[] = {
		{ "Speed against visible error; dashed: the Pareto front", "median frame, CPU ms", "mean FLIP", cost_ms,
			error_flip, true },
		{ "Speed against displacement", "median frame, CPU ms", "far pixels displaced by more than 1 px, %", cost_ms,
			error_displaced, false },
		{ "Memory against visible error", "resident, MiB", "mean FLIP", cost_mib, error_flip, false },
	};
	fputs("<h2>Plots</h2>\n", to);
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		write_scatter(tradeoff, to, &all[i]);
	write_frames(tradeoff, to, &(struct series){ "Time of every frame", "CPU ms", row_ms, 0 });
	write_frames(tradeoff, to, &(struct series){ "Popping", "change of the error, L* rms", row_popping, 1 });
}

static void write_choice(const struct tradeoff *tradeoff, FILE *to, const char *wish, const struct setting *setting)
{
	char name[48];
	if (setting)
		fprintf(to, "<tr><td>%s<td>%s<td>%.1f ms<td>FLIP %.4f<td>%.1f MiB</tr>\n", wish,
			name_of(tradeoff, setting, name), setting->cpu_ms.median, setting->flip,
			(double)setting->resident_bytes / 1048576.0);
	else
		fprintf(to, "<tr><td>%s<td colspan=\"4\">no setting does</tr>\n", wish);
}

static void write_advice(const struct tradeoff *tradeoff, FILE *to)
{
	static const double times_ms[] = { 8.0, 16.0, 33.0, 66.0, 100.0 };
	static const double flips[] = { 0.005, 0.01, 0.02, 0.05 };
	static const unsigned mibs[] = { 64, 128, 256, 512 };
	char wish[64];
	fputs("<h2>Which setting to use</h2>\n<p>On the machine that this was measured on.</p>\n<table class=\"t\">"
		  "<tr><th>wanted<th>use<th>median<th>error<th>memory</tr>\n",
		to);
	for (size_t i = 0; i < sizeof(times_ms) / sizeof(times_ms[0]); i++) {
		snprintf(wish, sizeof(wish), "a median frame of %g ms or less", times_ms[i]);
		write_choice(tradeoff, to, wish, tradeoff_within_ms(tradeoff, times_ms[i]));
	}
	for (size_t i = 0; i < sizeof(flips) / sizeof(flips[0]); i++) {
		snprintf(wish, sizeof(wish), "a mean FLIP of %g or less", flips[i]);
		write_choice(tradeoff, to, wish, tradeoff_within_flip(tradeoff, flips[i]));
	}
	for (size_t i = 0; i < sizeof(mibs) / sizeof(mibs[0]); i++) {
		snprintf(wish, sizeof(wish), "%u MiB or less", mibs[i]);
		write_choice(tradeoff, to, wish, tradeoff_within_bytes(tradeoff, (uint64_t)mibs[i] << 20));
	}
	fputs("</table>\n", to);
}

/* What is kept of a frame: file names end so, captions go on so. */
static const struct kept_picture {
	const char *suffix, *words;
} kept_pictures[] = {
	{ "", "" },
	{ "-difference", ": difference from full, 8 times" },
	{ "-displaced", ": far things within 1 px of their place green, farther off yellow, not found red" },
};

static void write_picture(FILE *to, const char *folder, const struct tradeoff_run *run, const char *name,
	uint32_t frame, const struct kept_picture *kept)
{
	char file[PATH_MAX], path[PATH_MAX];
	snprintf(file, sizeof(file), "tau-%g/pictures/%s-%06u%s.png", run->tau_px, name, frame, kept->suffix);
	if (snprintf(path, sizeof(path), "%s/%s", folder, file) >= (int)sizeof(path) || access(path, R_OK))
		return;
	fprintf(to,
		"<figure><img loading=\"lazy\" src=\"%s\" alt=\"\"><figcaption>%s%s, tau %g, frame %u</figcaption></figure>\n",
		file, name, kept->words, run->tau_px, frame);
}

static void write_pictures(const struct tradeoff *tradeoff, FILE *to, const char *folder)
{
	fputs("<h2>Frames</h2>\n", to);
	const struct trial_result *first = &tradeoff->runs.items[0].trial;
	for (size_t i = 0; i < first->rows[0].rows.count; i++) {
		uint32_t frame = first->rows[0].rows.items[i].frame;
		if (frame % tradeoff->config->every)
			continue;
		for (size_t r = 0; r < tradeoff->runs.count; r++) {
			const struct tradeoff_run *run = &tradeoff->runs.items[r];
			for (uint32_t k = r ? 1 : 0; k < run->trial.count; k++) {
				for (size_t p = 0; p < sizeof(kept_pictures) / sizeof(kept_pictures[0]); p++)
					write_picture(to, folder, run, run->trial.entrants[k].name, frame, &kept_pictures[p]);
			}
		}
	}
}

static void write_head(const struct tradeoff *tradeoff, FILE *to)
{
	const struct trial_config *c = tradeoff->config;
	fprintf(to,
		"<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Speed against "
		"accuracy</title>\n<style>%s</style>\n"
		"<h1>Speed against accuracy</h1>\n<p><code>",
		style);
	html_text(to, tradeoff->command);
	fputs("</code></p>\n<p>", to);
	html_text(to, tradeoff->runs.items[0].trial.gl_renderer);
	fprintf(to,
		", %u x %u, %u samples, %zu frames at %u a second; accuracy on every %uth. Representations draw the same "
		"frames in turn, in one process.</p>\n<table><tr><th>package<th>triangles<th>street km<th>MiB<th>far "
		"MiB<th>cells<th>impostors<th>geometry</tr>\n",
		c->width, c->height, c->samples, tradeoff->runs.items[0].trial.rows[0].rows.count, c->fps, c->every);
	for (size_t i = 0; i < tradeoff->runs.count; i++) {
		const struct tradeoff_run *run = &tradeoff->runs.items[i];
		fputs("<tr><td>", to);
		html_text(to, run->package);
		fprintf(to, "<td>%llu<td>%.1f<td>%.1f<td>%.1f<td>%u<td>%u<td>%u</tr>\n",
			(unsigned long long)run->facts.triangles, run->facts.street_km,
			(double)run->facts.package_bytes / 1048576.0, (double)run->facts.far_bytes / 1048576.0, run->facts.cells,
			run->facts.impostor_cells, run->facts.geometry_cells);
	}
	fputs("</table>\n", to);
}

int tradeoff_write_page(const struct tradeoff *tradeoff, const char *folder, const char *path)
{
	struct new_file file;
	int status = new_file_open(&file, path);
	if (status)
		return status;
	write_head(tradeoff, file.file);
	write_judged(tradeoff, file.file);
	write_settings(tradeoff, file.file);
	write_plots(tradeoff, file.file);
	write_advice(tradeoff, file.file);
	write_pictures(tradeoff, file.file, folder);
	fputs("</html>\n", file.file);
	return new_file_close(&file, 0);
}
