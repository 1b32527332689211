/* boulevard as a child of the simulation, for `blvd sim --run`. */
#ifndef BLVD_TOOLS_SIM_CHILD_H
#define BLVD_TOOLS_SIM_CHILD_H

#include <stdbool.h>
#include <sys/types.h>

#define CHILD_ARGUMENTS_MAX 64

struct child {
	pid_t pid;       /* 0: none, or ended */
	int status;      /* exit status once ended; 128 + signal */
	char folder[64]; /* for its pipes; "" none */
	char gpio[80], camera[80];
};

/* Makes a folder with the pipes that its simulated board and camera read. Returns 0 or -errno, logged. */
int child_prepare(struct child *child);

/* Starts it: boulevard beside blvd, in the build beside it, or on the path. `arguments` follow the package, and end
 * with NULL. Returns 0 or -errno, logged. */
int child_start(struct child *child, const char *package, const char *const *arguments);

/* Whether it still runs. */
bool child_runs(struct child *child);

/* Asks it to end, waits, and removes what child_prepare() made. Returns its exit status. A zeroed child does nothing.
 */
int child_end(struct child *child);

#endif
