/* Rows as CSV: a table of columns serves reading, writing and the head line. */
#include "tools/measure/trial_row.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"

enum column_kind { COLUMN_U32, COLUMN_U64, COLUMN_BOOL, COLUMN_DOUBLE };

static const struct column {
	const char *name;
	enum column_kind kind;
	size_t offset;
} columns[] = {
#define U32(field)                                                                                                     \
	{                                                                                                                  \
#field, COLUMN_U32, offsetof(struct trial_row, field)                                                          \
	}
#define U64(field)                                                                                                     \
	{                                                                                                                  \
#field, COLUMN_U64, offsetof(struct trial_row, field)                                                          \
	}
#define BOOL(field)                                                                                                    \
	{                                                                                                                  \
#field, COLUMN_BOOL, offsetof(struct trial_row, field)                                                         \
	}
#define DOUBLE(field)                                                                                                  \
	{                                                                                                                  \
#field, COLUMN_DOUBLE, offsetof(struct trial_row, field)                                                       \
	}
#define NAMED(name, field)                                                                                             \
	{                                                                                                                  \
		name, COLUMN_DOUBLE, offsetof(struct trial_row, field)                                                         \
	}
#define CLASS(name, i)                                                                                                 \
	{                                                                                                                  \
		"displaced_" name, COLUMN_U64, offsetof(struct trial_row, displacement.pixels[i])                              \
	}
	U32(frame),
	U32(half),
	U32(stretch),
	U32(place),
	U32(triangles),
	U32(far_triangles),
	U32(draws),
	U64(gpu_bytes),
	BOOL(fallback),
	BOOL(late),
	DOUBLE(error_px),
	BOOL(popping_known),
	NAMED("popping_mean", popping.mean),
	NAMED("popping_rms", popping.rms),
	NAMED("popping_p99", popping.p99),
	NAMED("popping_max", popping.max),
	BOOL(compared),
	DOUBLE(psnr_db),
	DOUBLE(ssim),
	DOUBLE(flip),
	DOUBLE(precision),
	DOUBLE(recall),
	DOUBLE(precision_2),
	DOUBLE(recall_2),
	U64(pixels),
	U64(drawn),
	U64(uncovered),
	U64(cracks),
	CLASS("0", 0),
	CLASS("eighth", 1),
	CLASS("quarter", 2),
	CLASS("half", 3),
	CLASS("1", 4),
	CLASS("2", 5),
	CLASS("4", 6),
	CLASS("8", 7),
	CLASS("16", 8),
	CLASS("lost", 9),
	NAMED("displaced_max_px", displacement.max_px),
	DOUBLE(cpu_ms),
	DOUBLE(wall_ms),
};
#define COLUMN_COUNT (sizeof(columns) / sizeof(columns[0]))

static void write_value(FILE *file, const struct column *column, const struct trial_row *row)
{
	const char *at = (const char *)row + column->offset;
	switch (column->kind) {
	case COLUMN_U32:
		fprintf(file, "%u", *(const uint32_t *)(const void *)at);
		break;
	case COLUMN_U64:
		fprintf(file, "%llu", (unsigned long long)*(const uint64_t *)(const void *)at);
		break;
	case COLUMN_BOOL:
		fputc(*(const bool *)(const void *)at ? '1' : '0', file);
		break;
	case COLUMN_DOUBLE:
		fprintf(file, "%.9g", *(const double *)(const void *)at);
		break;
	}
}

static bool read_value(const char *text, const struct column *column, struct trial_row *row)
{
	char *at = (char *)row + column->offset, *end = NULL;
	switch (column->kind) {
	case COLUMN_U32:
		*(uint32_t *)(void *)at = (uint32_t)strtoul(text, &end, 10);
		break;
	case COLUMN_U64:
		*(uint64_t *)(void *)at = strtoull(text, &end, 10);
		break;
	case COLUMN_BOOL:
		*(bool *)(void *)at = strtoul(text, &end, 10) != 0;
		break;
	case COLUMN_DOUBLE:
		*(double *)(void *)at = strtod(text, &end);
		break;
	}
	return end != text && !*end;
}

static void write_table(FILE *file, const struct trial_rows *rows)
{
	for (size_t c = 0; c < COLUMN_COUNT; c++)
		fprintf(file, "%s%s", c ? "," : "", columns[c].name);
	fputc('\n', file);
	for (size_t i = 0; i < rows->rows.count; i++) {
		for (size_t c = 0; c < COLUMN_COUNT; c++) {
			if (c)
				fputc(',', file);
			write_value(file, &columns[c], &rows->rows.items[i]);
		}
		fputc('\n', file);
	}
}

int trial_rows_write(const struct trial_rows *rows, const char *path)
{
	char part[PATH_MAX];
	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part))
		return -ENAMETOOLONG;
	FILE *file = fopen(part, "w");
	int status = file ? 0 : -errno;
	if (file) {
		write_table(file, rows);
		status = ferror(file) ? -EIO : 0;
		if (fclose(file) && !status)
			status = -errno;
	}
	if (!status && rename(part, path))
		status = -errno;
	if (status) {
		log_error("%s: cannot write: %s", path, strerror(-status));
		unlink(part);
	}
	return status;
}

static bool read_row(char *line, struct trial_row *row)
{
	char *rest = line;
	*row = (struct trial_row){ 0 };
	line[strcspn(line, "\n")] = '\0';
	for (size_t c = 0; c < COLUMN_COUNT; c++) {
		const char *field = strsep(&rest, ",");
		if (!field || !read_value(field, &columns[c], row))
			return false;
	}
	return !rest;
}

static bool is_head(char *line)
{
	char *rest = line;
	line[strcspn(line, "\n")] = '\0';
	for (size_t c = 0; c < COLUMN_COUNT; c++) {
		const char *field = strsep(&rest, ",");
		if (!field || strcmp(field, columns[c].name) != 0)
			return false;
	}
	return !rest;
}

int trial_rows_read(struct trial_rows *rows, const char *path)
{
	FILE *file = fopen(path, "r");
	if (!file)
		return -ENOENT;
	char line[4096];
	int status = 0;
	for (unsigned number = 1; !status && fgets(line, sizeof(line), file); number++) {
		struct trial_row row;
		if (number == 1 ? is_head(line) : read_row(line, &row)) {
			if (number > 1)
				ARRAY_PUSH(&rows->rows, row);
			continue;
		}
		log_error("%s:%u: no row of this program's", path, number);
		status = -EBADMSG;
	}
	fclose(file);
	return status;
}
