/* blvd verify: every check a package must pass. */
#include <argp.h>
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>

#include "assets/cells.h"
#include "assets/pkg.h"
#include "platform/base/log.h"
#include "tools/city/pool.h"
#include "tools/commands.h"
#include "tools/inspect/far_poses.h"

struct verify_options {
	const char *path;
	unsigned poses;
};

static const struct argp_option option_table[] = {
	{ "renders", 'r', "N", 0, "check the impostors' errors from N random poses a cell; needs bake --truth", 0 },
	{ 0 },
};

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	struct verify_options *options = state->input;
	char *end;
	long poses;
	switch (key) {
	case 'r':
		poses = strtol(value, &end, 10);
		if (end == value || *end || poses < 1 || poses > 10000)
			argp_error(state, "--renders wants a number from 1 to 10000, not '%s'", value);
		options->poses = (unsigned)poses;
		return 0;
	case ARGP_KEY_ARG:
		if (options->path)
			argp_error(state, "one package at a time");
		options->path = value;
		return 0;
	case ARGP_KEY_END:
		if (!options->path)
			argp_error(state, "no package");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp parser = {
	.options = option_table,
	.parser = parse_option,
	.args_doc = "CITY.blvd",
	.doc = "Checks every byte of a package. Exit status 3 and the first fault when it fails.",
};

/* What is inside the far field's blobs. */
static int verify_blobs(const struct pkg *pkg, struct pkg_fault *fault)
{
	struct pool pool = { 0 };
	struct arena arena;
	size_t bytes = cells_verify_bytes(pkg);
	arena_init(&arena, "verify", pool_alloc(&pool, bytes), bytes);
	int status = cells_verify(pkg, &arena, fault);
	pool_finish(&pool);
	return status;
}

/* One pixel in a thousand may be beyond: what a texel shows is the mean of several pixels, of one object if not of one
 * surface. */
#define BEYOND_SHARE 0.001

static int verify_poses(const struct pkg *pkg, const struct verify_options *options)
{
	struct far_poses_result result;
	int err = far_poses_check(pkg, options->poses, &result);
	if (err == -ENODATA)
		log_error("%s: no impostor with its truth in it: bake with --truth", options->path);
	if (err)
		return EXIT_BAD_INPUT;
	double pixels = (double)result.pixels;
	printf(
		"%llu cells, %llu pixels from %u poses each: displaced by %.3f px (median), %.3f (99 %%), %.3f (99.9 %%), %.2f "
		"(most); over what was asked for %.4f %%, over what the cell says %.4f %%; another %.2f %% shows what no "
		"capture saw\n",
		(unsigned long long)result.cells, (unsigned long long)result.pixels, options->poses, result.p50_px,
		result.p99_px, result.p999_px, result.max_px, 100.0 * (double)result.over_tau / pixels,
		100.0 * (double)result.over_error / pixels, 100.0 * (double)result.made_up / (pixels + (double)result.made_up));
	if ((double)result.over_error <= BEYOND_SHARE * pixels)
		return EXIT_DONE;
	log_error("%s: impostors are displaced by more than they say", options->path);
	return EXIT_BAD_INPUT;
}

int cmd_verify(int argc, char **argv)
{
	struct verify_options options = { 0 };
	argp_parse(&parser, argc, argv, 0, NULL, &options);
	const char *path = options.path;
	struct pkg pkg;
	struct pkg_fault fault;
	int status = pkg_open(&pkg, path, &fault);
	if (status == 0)
		status = pkg_verify(&pkg, &fault);
	if (status == 0 && pkg.stretches)
		status = verify_blobs(&pkg, &fault);
	if (status < 0) {
		log_error("%s: byte %llu: %s", path, (unsigned long long)fault.offset, fault.text);
		pkg_close(&pkg);
		return EXIT_BAD_INPUT;
	}
	printf("%s: sound: %u chunks, %llu triangles, %u edges", path, pkg.chunk_count,
		(unsigned long long)pkg.meta->triangle_count, pkg.graph.edge_count);
	if (pkg.stretches)
		printf(", %u stretches", pkg.stretch_count);
	putchar('\n');
	int exit_status = options.poses ? verify_poses(&pkg, &options) : EXIT_DONE;
	pkg_close(&pkg);
	return exit_status;
}
