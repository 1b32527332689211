/* blvd verify: every check a package must pass. */
#include <argp.h>
#include <errno.h>
#include <stdio.h>

#include "assets/cells.h"
#include "assets/pkg.h"
#include "platform/base/log.h"
#include "tools/city/pool.h"
#include "tools/commands.h"

static error_t parse_option(int key, char *value, struct argp_state *state)
{
	const char **path = state->input;
	switch (key) {
	case ARGP_KEY_ARG:
		if (*path)
			argp_error(state, "one package at a time");
		*path = value;
		return 0;
	case ARGP_KEY_END:
		if (!*path)
			argp_error(state, "no package");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static const struct argp parser = {
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

int cmd_verify(int argc, char **argv)
{
	const char *path = NULL;
	argp_parse(&parser, argc, argv, 0, NULL, &path);
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
	pkg_close(&pkg);
	return EXIT_DONE;
}
