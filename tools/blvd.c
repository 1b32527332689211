/* The toolbox: one program, one subcommand a job. Each cmd_*.c parses its own arguments with argp. */
#include <argp.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/commands.h"

static const struct command {
	const char *name;
	int (*run)(int argc, char **argv);
	const char *summary;
} commands[] = {
	{ "bake", cmd_bake, "map data into a city package" },
	{ "compare", cmd_compare, "how two pictures differ, as JSON" },
	{ "drive", cmd_drive, "a driven route as a CAN log" },
	{ "inspect", cmd_inspect, "what is in a package" },
	{ "sim", cmd_sim, "the virtual car, live on a CAN bus" },
	{ "synth", cmd_synth, "a made-up city as OSM" },
	{ "track", cmd_track, "how well a log is followed, as JSON" },
	{ "tradeoff", cmd_tradeoff, "speed against accuracy of the representations, over a drive" },
	{ "verify", cmd_verify, "every check a package must pass" },
	{ "shot", cmd_shot, "a still picture of a package from any pose" },
	{ NULL, NULL, NULL },
};

static void print_usage(FILE *to)
{
	fprintf(to, "usage: blvd COMMAND [ARGUMENT...]\n\ncommands:\n");
	for (const struct command *command = commands; command->name; command++)
		fprintf(to, "  %-10s %s\n", command->name, command->summary);
	fprintf(to, "\n'blvd COMMAND --help' tells a command's options; 'man blvd' tells the rest.\n");
}

/* Help and errors of argp name the program by argv[0]. */
static int run_command(const struct command *command, int argc, char **argv)
{
	static char name[32];
	snprintf(name, sizeof(name), "blvd %s", command->name);
	argv[0] = name;
	return command->run(argc, argv);
}

int main(int argc, char **argv)
{
	log_init("blvd", LOG_INFO);
	argp_err_exit_status = EXIT_USAGE;
	signal(SIGXFSZ, SIG_IGN); /* a file that may not grow is an error to its writer, no more */
	if (argc < 2) {
		print_usage(stderr);
		return EXIT_USAGE;
	}
	if (!strcmp(argv[1], "--help") || !strcmp(argv[1], "help")) {
		print_usage(stdout);
		return EXIT_DONE;
	}
	if (!strcmp(argv[1], "--version")) {
		puts("blvd " BLVD_VERSION);
		return EXIT_DONE;
	}
	for (const struct command *command = commands; command->name; command++)
		if (!strcmp(argv[1], command->name))
			return run_command(command, argc - 1, argv + 1);
	fprintf(stderr, "blvd: error: no command '%s'\n", argv[1]);
	print_usage(stderr);
	return EXIT_USAGE;
}
