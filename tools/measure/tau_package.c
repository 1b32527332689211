#include "tools/measure/tau_package.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/far/far.h"
#include "tools/measure/tradeoff.h"

static int open_package(struct pkg *pkg, const char *path)
{
	struct pkg_fault fault = { 0 };
	int status = pkg_open(pkg, path, &fault);
	if (status < 0)
		log_error("%s: %s", path, status == -EBADMSG ? fault.text : strerror(-status));
	return status;
}

double tau_package_tau(const char *package)
{
	struct pkg pkg;
	double tau_px = 0.0;
	if (open_package(&pkg, package) < 0)
		return -1.0;
	for (uint32_t i = 0; pkg.stretches && i < 2 * pkg.stretch_count && tau_px <= 0.0; i++)
		tau_px = (double)pkg.cells[i].tau_px;
	pkg_close(&pkg);
	return tau_px;
}

/* Beside the package, since the package itself is the same whoever baked it how fast. */
static void seconds_path(const char *path, char out[PATH_MAX])
{
	snprintf(out, PATH_MAX, "%s.seconds", path);
}

static double read_seconds(const char *path)
{
	char name[PATH_MAX];
	double seconds = 0.0;
	seconds_path(path, name);
	FILE *file = fopen(name, "r");
	if (file && fscanf(file, "%lf", &seconds) != 1)
		seconds = 0.0;
	if (file)
		fclose(file);
	return seconds;
}

static int write_seconds(const char *path, double seconds)
{
	char name[PATH_MAX];
	struct new_file file;
	seconds_path(path, name);
	int status = new_file_open(&file, name);
	if (status)
		return status;
	fprintf(file.file, "%.3f\n", seconds);
	return new_file_close(&file, 0);
}

int tau_package_make(const char *city, const char *log, double tau_px, const char *path, double *seconds)
{
	*seconds = read_seconds(path);
	if (!access(path, R_OK))
		return 0;
	struct pkg pkg;
	int status = open_package(&pkg, city);
	if (status < 0)
		return -EBADMSG;
	struct far_options options = { .selection = log,
		.cells = { .pvs = true, .impostor = true, .truth = true, .tau_px = tau_px } };
	int64_t began = clock_now_ns();
	int code = far_bake(&pkg, path, &options);
	pkg_close(&pkg);
	*seconds += (double)(clock_now_ns() - began) * 1e-9;
	if (code == EXIT_DONE)
		return write_seconds(path, *seconds);
	return code == EXIT_BAD_INPUT ? -EBADMSG : -EIO;
}
