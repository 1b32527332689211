#include "tools/sim/child.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

#define PATIENCE_NS (5 * NS_PER_S)

static int fail(const char *what)
{
	int status = -errno;
	log_error("%s: %s", what, strerror(-status));
	return status;
}

int child_prepare(struct child *child)
{
	*child = (struct child){ 0 };
	snprintf(child->folder, sizeof(child->folder), "/tmp/blvd-sim-XXXXXX");
	if (!mkdtemp(child->folder)) {
		child->folder[0] = 0;
		return fail("/tmp");
	}
	snprintf(child->gpio, sizeof(child->gpio), "%s/gpio", child->folder);
	snprintf(child->camera, sizeof(child->camera), "%s/camera", child->folder);
	if (mkfifo(child->gpio, 0600) < 0 || mkfifo(child->camera, 0600) < 0)
		return fail(child->folder);
	return 0;
}

/* In an installation the two are in one folder, in a build side by side. */
static void find_program(char *out, size_t size)
{
	static const char *const beside[] = { "boulevard", "../board/boulevard" };
	char self[512];
	ssize_t n = readlink("/proc/self/exe", self, sizeof(self) - 1);
	self[n > 0 ? n : 0] = 0;
	char *slash = strrchr(self, '/');
	for (size_t i = 0; slash && i < sizeof(beside) / sizeof(beside[0]); i++) {
		slash[1] = 0;
		if (snprintf(out, size, "%s%s", self, beside[i]) < (int)size && access(out, X_OK) == 0)
			return;
	}
	snprintf(out, size, "boulevard"); /* on the path */
}

int child_start(struct child *child, const char *package, const char *const *arguments)
{
	char program[600];
	const char *all[CHILD_ARGUMENTS_MAX + 3] = { "boulevard", package };
	size_t count = 2;
	for (; *arguments && count < CHILD_ARGUMENTS_MAX; arguments++)
		all[count++] = *arguments;
	find_program(program, sizeof(program));
	child->pid = fork();
	if (child->pid < 0) {
		child->pid = 0;
		return fail("fork");
	}
	if (child->pid > 0)
		return 0;
	setpgid(0, 0);                       /* ^C is the simulation's to hear */
	execvp(program, (char *const *)all); /* NOLINT: exec takes them as they are */
	log_error("%s: %s", program, strerror(errno));
	_exit(127);
}

static void note_end(struct child *child, int status)
{
	child->status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
	child->pid = 0;
}

bool child_runs(struct child *child)
{
	int status;
	if (child->pid > 0 && waitpid(child->pid, &status, WNOHANG) == child->pid)
		note_end(child, status);
	return child->pid > 0;
}

int child_end(struct child *child)
{
	int64_t deadline = clock_now_ns() + PATIENCE_NS;
	if (child->pid > 0)
		kill(child->pid, SIGTERM);
	while (child_runs(child) && clock_now_ns() < deadline)
		usleep(10000);
	if (child->pid > 0) {
		int status;
		kill(child->pid, SIGKILL);
		if (waitpid(child->pid, &status, 0) == child->pid)
			note_end(child, status);
	}
	if (child->folder[0]) {
		unlink(child->gpio);
		unlink(child->camera);
		rmdir(child->folder);
		child->folder[0] = 0;
	}
	return child->status;
}
