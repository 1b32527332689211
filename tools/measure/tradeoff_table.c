/* What was asked of the impostors, what [S97] published, and what was measured. */
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "tools/measure/tradeoff.h"

struct table {
	struct judged_row *rows;
	unsigned count;
};

__attribute__((format(printf, 5, 6))) static void add(
	struct table *table, const char *what, const char *published, const char *asked, const char *format, ...)
{
	struct judged_row *row = &table->rows[table->count++];
	va_list args;
	snprintf(row->what, sizeof(row->what), "%s", what);
	snprintf(row->published, sizeof(row->published), "%s", published);
	snprintf(row->asked, sizeof(row->asked), "%s", asked);
	va_start(args, format);
	vsnprintf(row->measured, sizeof(row->measured), format, args);
	va_end(args);
}

/* The one the table is about: impostors at tau 1, or what there is. */
static const struct setting *judged(const struct tradeoff *tradeoff)
{
	const struct setting *out = tradeoff_find(tradeoff, "impostor", 1.0);
	if (!out)
		out = tradeoff_find(tradeoff, "impostor", -1.0);
	return out ? out : &tradeoff->settings.items[tradeoff->settings.count - 1];
}

static const struct tradeoff_run *run_of(const struct tradeoff *tradeoff, const struct setting *setting)
{
	for (size_t i = 0; i < tradeoff->runs.count; i++)
		if (tradeoff->runs.items[i].tau_px == setting->tau_px)
			return &tradeoff->runs.items[i];
	return &tradeoff->runs.items[0];
}

static const char *asked_speed(double triangles)
{
	return triangles < 0.4e6 ? ">= 3x at 0.14 M" : triangles < 2.5e6 ? ">= 8x at 1 M" : ">= 30x at 5 M";
}

static void add_speed(struct table *table, const struct setting *s, const struct far_facts *facts)
{
	char what[120];
	snprintf(what, sizeof(what), "speed-up of the median frame over full, %.2f M triangles",
		(double)facts->triangles * 1e-6);
	add(table, what, "8-11x at 0.14 M, hardware of 1997", asked_speed((double)facts->triangles),
		"%.1fx (CPU time, all threads); %.1fx by the clock", s->speed_up, s->speed_up_wall);
	if (s->speed_up_pvs > 0.0)
		add(table, "speed-up over pvs where far things are in view", "none given", ">= 2x", "%.2fx", s->speed_up_pvs);
	else
		add(table, "speed-up over pvs where far things are in view", "none given", ">= 2x", "not measured");
	add(table, "impostor triangles, median / p99", "~1,000, no bound", "<= 1,000 / <= 3,000",
		"%.0f / %.0f stored a cell; %.0f / %.0f far triangles drawn a frame", facts->cell_triangles.median,
		facts->cell_triangles.p99, s->far_triangles.median, s->far_triangles.p99);
}

static void add_accuracy(struct table *table, const struct setting *s)
{
	add(table, "far pixels displaced by <= 1 px over the drive", "not measured", ">= 99.5 %",
		"%.2f %% (p99 %.2f px; %.3f %% not found)", 100.0 * displacement_share(&s->displacement, 1.0),
		displacement_quantile(&s->displacement, 0.99), 100.0 * displacement_share_lost(&s->displacement));
	add(table, "uncovered pixels where full has geometry, worst frame", "up to 12 %", "<= 0.05 %",
		"%.3f %% (mean %.4f %%)", 100.0 * s->uncovered_worst, 100.0 * s->uncovered_mean);
	add(table, "cracks between near and far", "some", "0", "%llu px in %u frames", (unsigned long long)s->cracks,
		s->compared);
	if (s->popping_ratio > 0.0)
		add(table, "change at a transition against inside cells (popping)", "visible", "max <= 1.5x of the in-cell p99",
			"%.2fx (L* rms: %.2f at a change, %.2f settling, in-cell p99 %.2f; %u changes)", s->popping_ratio,
			s->popping_change_max, s->popping_settling_max, s->popping_inside_p99, s->cell_changes);
	else
		add(table, "change at a transition against inside cells (popping)", "visible", "max <= 1.5x of the in-cell p99",
			"no cells, or no change");
}

static void add_cost(struct table *table, const struct setting *s, const struct far_facts *facts)
{
	if (facts->bake_seconds > 0.0 && facts->directed_edges)
		add(table, "bake per directed edge", "12 s", "<= 0.5 s median", "%.2f s mean",
			facts->bake_seconds / facts->directed_edges);
	else
		add(table, "bake per directed edge", "12 s", "<= 0.5 s median", "not measured here");
	add(table, "bytes per directed edge, median", "768 KiB of texture", "<= 64 KiB",
		"%.1f KiB (mean %.1f KiB, %u edges)", facts->edge_bytes_median / 1024.0, facts->edge_bytes_mean / 1024.0,
		facts->directed_edges);
	add(table, "resident memory, everything included", "not bounded", "<= 64 MiB",
		"%.1f MiB; the package's bound %.1f MiB", (double)s->resident_bytes / 1048576.0,
		(double)facts->resident_bound_bytes / 1048576.0);
	double median = fmax(s->cpu_ms.median, 1e-9);
	add(table, "worst frame against median", "", "p99.9 <= 2x, none over 3x, 0 fallback frames at 50 km/h",
		"p99.9 %.2fx, max %.2fx, %u fallback frames (%u late) of %u", s->cpu_ms.p999 / median, s->cpu_ms.max / median,
		s->fallback_frames, s->late_frames, s->frames);
}

unsigned tradeoff_judge(const struct tradeoff *tradeoff, struct judged_row rows[JUDGED_ROWS_MAX])
{
	struct table table = { .rows = rows };
	if (!tradeoff->settings.count)
		return 0;
	const struct setting *setting = judged(tradeoff);
	const struct far_facts *facts = &run_of(tradeoff, setting)->facts;
	add_speed(&table, setting, facts);
	add_accuracy(&table, setting);
	add_cost(&table, setting, facts);
	return table.count;
}

int tradeoff_write_table(const struct tradeoff *tradeoff, const char *path)
{
	struct judged_row rows[JUDGED_ROWS_MAX];
	struct new_file file;
	int status = new_file_open(&file, path);
	if (status)
		return status;
	unsigned count = tradeoff_judge(tradeoff, rows);
	fprintf(file.file, "Of `%s`, by\n\n    %s\n\n| what | [S97] | asked | measured |\n|---|---|---|---|\n",
		count ? judged(tradeoff)->name : "none", tradeoff->command);
	for (unsigned i = 0; i < count; i++)
		fprintf(file.file, "| %s | %s | %s | %s |\n", rows[i].what, rows[i].published, rows[i].asked, rows[i].measured);
	return new_file_close(&file, 0);
}
