/* A bake of the far field from end to end: plan, workers, sections. */
#include <dirent.h>
#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/far/assemble.h"
#include "tools/far/far.h"
#include "tools/far/plan.h"
#include "tools/far/workers.h"

int far_units_folder(const struct far_options *options, const char *output, char *out)
{
	int length =
		options->units ? snprintf(out, PATH_MAX, "%s", options->units) : snprintf(out, PATH_MAX, "%s.cells", output);
	int err = length < PATH_MAX ? 0 : -ENAMETOOLONG;
	if (!err && mkdir(out, 0777) && errno != EEXIST)
		err = -errno;
	if (err)
		log_error("%s: %s", options->units ? options->units : output, strerror(-err));
	return err;
}

/* Takes away the units, and the folder if nothing else is in it. */
static void remove_units(const char *folder)
{
	DIR *dir = opendir(folder);
	if (!dir)
		return;
	for (struct dirent *entry; (entry = readdir(dir));) {
		const char *dot = strchr(entry->d_name, '.');
		if (dot && !strncmp(dot, ".unit", 5))
			unlinkat(dirfd(dir), entry->d_name, 0);
	}
	closedir(dir);
	rmdir(folder);
}

static void report(
	const struct far_plan *plan, const struct far_sections *sections, const struct far_counts *counts, double seconds)
{
	static const char *const names[] = { "nothing", "geometry", "impostor" };
	uint64_t kinds[PKG_CELL_KIND_COUNT] = { 0 };
	for (size_t i = 0; i < sections->cells.count; i++)
		kinds[sections->cells.items[i].kind]++;
	printf("far field: %zu of %u stretches, %llu of them unchanged, %.1f MiB, %.0f s\n", plan->stretches.count,
		plan->cut_count, (unsigned long long)counts->reused, (double)sections->blob_bytes / 1048576.0, seconds);
	printf("  cells:");
	for (int i = 0; i < PKG_CELL_KIND_COUNT; i++)
		printf(" %s %llu%s", names[i], (unsigned long long)kinds[i], i + 1 < PKG_CELL_KIND_COUNT ? "," : "\n");
	double made = (double)(counts->stretches - counts->reused);
	const struct cell_times *t = &counts->times;
	if (made > 0.0)
		printf("  processor ms a stretch: visible %.0f, looks %.0f, captures %.0f, wanted %.0f, meshes %.0f, storing "
			   "%.0f\n",
			1e3 * counts->visible_s / (double)counts->stretches, 1e3 * t->look / made, 1e3 * t->capture / made,
			1e3 * t->wanted / made, 1e3 * t->build / made, 1e3 * t->store / made);
}

static unsigned core_count(void)
{
	long cores = sysconf(_SC_NPROCESSORS_ONLN);
	return cores > 0 ? (unsigned)cores : 1;
}

static int bake(const struct pkg *pkg, const struct pkg *old, const char *output, const char *folder,
	const struct far_options *options)
{
	struct far_plan plan;
	struct far_sections sections = { 0 };
	struct cell_options cells = cell_options_settled(&options->cells, pkg);
	int64_t started = clock_now_ns();
	int err = far_plan_make(&plan, pkg, options);
	if (err) {
		far_plan_finish(&plan);
		return err == -EINVAL ? EXIT_USAGE : EXIT_BAD_INPUT;
	}
	struct far_work work = { .pkg = pkg,
		.old = old,
		.plan = &plan,
		.cells = &cells,
		.folder = folder,
		.jobs = options->jobs ? options->jobs : core_count(),
		.show_progress = !options->quiet && isatty(STDERR_FILENO) };
	struct far_counts counts;
	uint64_t *hashes = array_grow(NULL, &(size_t){ 0 }, far_plan_units(&plan) + 1, sizeof(*hashes));
	err = far_work_run(&work, hashes, &counts);
	if (!err)
		err = far_sections_gather(&sections, &plan, folder, hashes);
	if (!err)
		err = far_assemble(output, pkg, &plan, &sections, folder, hashes, 0);
	if (!err && !options->quiet)
		report(&plan, &sections, &counts, (double)(clock_now_ns() - started) * 1e-9);
	far_sections_finish(&sections);
	far_plan_finish(&plan);
	array_free(hashes);
	return err ? EXIT_FAILED : EXIT_DONE;
}

int far_bake(const struct pkg *pkg, const char *output, const struct far_options *options)
{
	char folder[PATH_MAX];
	if (far_units_folder(options, output, folder))
		return EXIT_FAILED;
	/* What the output holds already need not be made again. */
	struct pkg old = { 0 };
	struct pkg_fault fault;
	bool reuse = !pkg_open(&old, output, &fault) && old.stretches;
	int status = bake(pkg, reuse ? &old : NULL, output, folder, options);
	pkg_close(&old);
	if (status == EXIT_DONE && !options->units)
		remove_units(folder);
	return status;
}

int far_strip(const struct pkg *pkg, const char *output)
{
	return far_assemble(output, pkg, NULL, NULL, NULL, NULL, 0) ? EXIT_FAILED : EXIT_DONE;
}
