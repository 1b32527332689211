/*
 * The subcommands of blvd. Each takes its own argv (argv[0] is the command's name) and returns an exit status.
 */
#ifndef BLVD_TOOLS_COMMANDS_H
#define BLVD_TOOLS_COMMANDS_H

enum exit_status {
	EXIT_DONE = 0,
	EXIT_FAILED = 1,    /* while running: disk full, no GL */
	EXIT_USAGE = 2,     /* wrong command line */
	EXIT_BAD_INPUT = 3, /* an input file is missing or wrong; one line names it and the place */
};

int cmd_bake(int argc, char **argv);
int cmd_synth(int argc, char **argv);
int cmd_drive(int argc, char **argv);
int cmd_compare(int argc, char **argv);
int cmd_inspect(int argc, char **argv);
int cmd_track(int argc, char **argv);
int cmd_tradeoff(int argc, char **argv);
int cmd_verify(int argc, char **argv);
int cmd_sim(int argc, char **argv);
int cmd_shot(int argc, char **argv);

#endif
