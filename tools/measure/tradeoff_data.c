/* Settings as CSV and JSON. */
#include <cjson/cJSON.h>
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "tools/measure/tradeoff.h"

int new_file_open(struct new_file *file, const char *path)
{
	int status = 0;
	if (snprintf(file->path, sizeof(file->path), "%s", path) >= (int)sizeof(file->path) ||
		snprintf(file->part, sizeof(file->part), "%s.part", path) >= (int)sizeof(file->part))
		status = -ENAMETOOLONG;
	else if (!(file->file = fopen(file->part, "w")))
		status = -errno;
	if (status)
		log_error("%s: cannot write: %s", path, strerror(-status));
	return status;
}

int new_file_close(struct new_file *file, int status)
{
	if (!status && ferror(file->file))
		status = -EIO;
	if (fclose(file->file) && !status)
		status = -errno;
	if (!status && rename(file->part, file->path))
		status = -errno;
	if (status) {
		log_error("%s: cannot write: %s", file->path, strerror(-status));
		unlink(file->part);
	}
	return status;
}

/* One list for both: what a setting comes to. */
struct figure {
	const char *name;
	double value;
};
#define FIGURES_MAX 64

static unsigned list_spread(struct figure *out, const char *const names[6], const struct spread *s)
{
	const double values[6] = { s->median, s->p95, s->p99, s->p999, s->max, s->mean };
	for (unsigned i = 0; i < 6; i++)
		out[i] = (struct figure){ names[i], values[i] };
	return 6;
}

static unsigned list_speed(struct figure *out, const struct setting *s)
{
	static const char *const cpu[6] = { "cpu_ms_median", "cpu_ms_p95", "cpu_ms_p99", "cpu_ms_p999", "cpu_ms_max",
		"cpu_ms_mean" };
	static const char *const wall[6] = { "wall_ms_median", "wall_ms_p95", "wall_ms_p99", "wall_ms_p999", "wall_ms_max",
		"wall_ms_mean" };
	unsigned count = list_spread(out, cpu, &s->cpu_ms);
	count += list_spread(out + count, wall, &s->wall_ms);
	const struct figure more[] = {
		{ "speed_up", s->speed_up },
		{ "speed_up_wall", s->speed_up_wall },
		{ "speed_up_over_pvs", s->speed_up_pvs },
		{ "triangles_median", s->triangles.median },
		{ "triangles_p99", s->triangles.p99 },
		{ "triangles_max", s->triangles.max },
		{ "far_triangles_median", s->far_triangles.median },
		{ "far_triangles_p99", s->far_triangles.p99 },
		{ "far_triangles_max", s->far_triangles.max },
		{ "draws_median", s->draws.median },
		{ "draws_max", s->draws.max },
		{ "start_ms", s->start_ms },
		{ "first_frame_ms", s->first_frame_ms },
		{ "resident_bytes", (double)s->resident_bytes },
		{ "fallback_frames", s->fallback_frames },
		{ "late_frames", s->late_frames },
		{ "cell_changes", s->cell_changes },
	};
	memcpy(out + count, more, sizeof(more));
	return count + sizeof(more) / sizeof(more[0]);
}

static unsigned list_accuracy(struct figure *out, const struct setting *s)
{
	const struct figure all[] = {
		{ "psnr_db", s->psnr_db },
		{ "psnr_db_worst", s->psnr_db_worst },
		{ "ssim", s->ssim },
		{ "ssim_worst", s->ssim_worst },
		{ "flip", s->flip },
		{ "flip_worst", s->flip_worst },
		{ "precision", s->precision },
		{ "recall", s->recall },
		{ "precision_within_2", s->precision_2 },
		{ "recall_within_2", s->recall_2 },
		{ "far_pixels", (double)displacement_total(&s->displacement) },
		{ "displaced_px_p50", displacement_quantile(&s->displacement, 0.5) },
		{ "displaced_px_p99", displacement_quantile(&s->displacement, 0.99) },
		{ "displaced_px_max", s->displacement.max_px },
		{ "displaced_within_1_px", displacement_share(&s->displacement, 1.0) },
		{ "not_found", displacement_share_lost(&s->displacement) },
		{ "uncovered", s->uncovered_mean },
		{ "uncovered_worst", s->uncovered_worst },
		{ "cracks", (double)s->cracks },
		{ "popping_inside_p99", s->popping_inside_p99 },
		{ "popping_change_max", s->popping_change_max },
		{ "popping_settling_max", s->popping_settling_max },
		{ "popping_ratio", s->popping_ratio },
	};
	memcpy(out, all, sizeof(all));
	return sizeof(all) / sizeof(all[0]);
}

static unsigned list_figures(struct figure out[FIGURES_MAX], const struct setting *s)
{
	unsigned count = list_speed(out, s);
	return count + list_accuracy(out + count, s);
}

int tradeoff_write_csv(const struct tradeoff *tradeoff, const char *path)
{
	struct new_file file;
	struct figure figures[FIGURES_MAX];
	int status = new_file_open(&file, path);
	if (status)
		return status;
	for (size_t i = 0; i < tradeoff->settings.count; i++) {
		const struct setting *s = &tradeoff->settings.items[i];
		unsigned count = list_figures(figures, s);
		if (i == 0) {
			fputs("representation,tau_px,frames,compared,pareto", file.file);
			for (unsigned k = 0; k < count; k++)
				fprintf(file.file, ",%s", figures[k].name);
			fputc('\n', file.file);
		}
		fprintf(file.file, "%s,%g,%u,%u,%d", s->name, s->tau_px, s->frames, s->compared, s->pareto);
		for (unsigned k = 0; k < count; k++)
			fprintf(file.file, ",%.9g", figures[k].value);
		fputc('\n', file.file);
	}
	return new_file_close(&file, 0);
}

static cJSON *json_of_setting(const struct setting *s)
{
	struct figure figures[FIGURES_MAX];
	cJSON *out = cJSON_CreateObject();
	cJSON_AddStringToObject(out, "representation", s->name);
	cJSON_AddNumberToObject(out, "tau_px", s->tau_px);
	cJSON_AddNumberToObject(out, "frames", s->frames);
	cJSON_AddNumberToObject(out, "compared", s->compared);
	cJSON_AddBoolToObject(out, "pareto", s->pareto);
	unsigned count = list_figures(figures, s);
	for (unsigned k = 0; k < count; k++) {
		if (isfinite(figures[k].value))
			cJSON_AddNumberToObject(out, figures[k].name, figures[k].value);
		else
			cJSON_AddNullToObject(out, figures[k].name);
	}
	return out;
}

static cJSON *json_of_run(const struct tradeoff_run *run)
{
	const struct far_facts *f = &run->facts;
	cJSON *out = cJSON_CreateObject();
	cJSON_AddStringToObject(out, "package", run->package);
	cJSON_AddNumberToObject(out, "tau_px", run->tau_px);
	const struct figure figures[] = {
		{ "triangles", (double)f->triangles },
		{ "package_bytes", (double)f->package_bytes },
		{ "far_bytes", (double)f->far_bytes },
		{ "resident_bound_bytes", (double)f->resident_bound_bytes },
		{ "street_km", f->street_km },
		{ "directed_edges", f->directed_edges },
		{ "edge_bytes_median", f->edge_bytes_median },
		{ "edge_bytes_mean", f->edge_bytes_mean },
		{ "cells", f->cells },
		{ "impostor_cells", f->impostor_cells },
		{ "geometry_cells", f->geometry_cells },
		{ "relaxed_cells", f->relaxed_cells },
		{ "cell_triangles_median", f->cell_triangles.median },
		{ "cell_triangles_p99", f->cell_triangles.p99 },
		{ "cell_triangles_max", f->cell_triangles.max },
		{ "bake_seconds", f->bake_seconds },
	};
	for (size_t i = 0; i < sizeof(figures) / sizeof(figures[0]); i++)
		cJSON_AddNumberToObject(out, figures[i].name, figures[i].value);
	return out;
}

static cJSON *json_of(const struct tradeoff *tradeoff)
{
	const struct trial_config *c = tradeoff->config;
	cJSON *out = cJSON_CreateObject();
	cJSON_AddStringToObject(out, "command", tradeoff->command);
	cJSON_AddStringToObject(out, "renderer", tradeoff->runs.items[0].trial.gl_renderer);
	cJSON *size = cJSON_AddArrayToObject(out, "size");
	cJSON_AddItemToArray(size, cJSON_CreateNumber(c->width));
	cJSON_AddItemToArray(size, cJSON_CreateNumber(c->height));
	cJSON_AddNumberToObject(out, "samples", c->samples);
	cJSON_AddNumberToObject(out, "fps", c->fps);
	cJSON *runs = cJSON_AddArrayToObject(out, "packages");
	for (size_t i = 0; i < tradeoff->runs.count; i++)
		cJSON_AddItemToArray(runs, json_of_run(&tradeoff->runs.items[i]));
	cJSON *settings = cJSON_AddArrayToObject(out, "settings");
	for (size_t i = 0; i < tradeoff->settings.count; i++)
		cJSON_AddItemToArray(settings, json_of_setting(&tradeoff->settings.items[i]));
	struct judged_row rows[JUDGED_ROWS_MAX];
	unsigned count = tradeoff_judge(tradeoff, rows);
	cJSON *table = cJSON_AddArrayToObject(out, "table");
	for (unsigned i = 0; i < count; i++) {
		cJSON *row = cJSON_CreateObject();
		cJSON_AddStringToObject(row, "what", rows[i].what);
		cJSON_AddStringToObject(row, "published", rows[i].published);
		cJSON_AddStringToObject(row, "asked", rows[i].asked);
		cJSON_AddStringToObject(row, "measured", rows[i].measured);
		cJSON_AddItemToArray(table, row);
	}
	return out;
}

int tradeoff_write_json(const struct tradeoff *tradeoff, const char *path)
{
	struct new_file file;
	int status = new_file_open(&file, path);
	if (status)
		return status;
	cJSON *json = json_of(tradeoff);
	char *text = cJSON_Print(json);
	status = text && fputs(text, file.file) >= 0 && fputc('\n', file.file) >= 0 ? 0 : -EIO;
	cJSON_free(text);
	cJSON_Delete(json);
	return new_file_close(&file, status);
}
