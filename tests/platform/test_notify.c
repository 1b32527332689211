/* What the service manager hears, from a socket that stands for it. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/notify.h"

struct manager {
	int fd;
	char folder[32], name[64];
};

/* Listens at a path, or at an abstract name, and tells the environment. */
static void listen_at(struct manager *m, bool abstract)
{
	struct sockaddr_un address = { .sun_family = AF_UNIX };
	*m = (struct manager){ .folder = "/tmp/blvd-test-notify-XXXXXX" };
	assert_non_null(mkdtemp(m->folder));
	snprintf(m->name, sizeof(m->name), "%s%s/socket", abstract ? "@" : "", m->folder);
	snprintf(address.sun_path, sizeof(address.sun_path), "%s", m->name);
	size_t length = sizeof(address);
	if (abstract) {
		address.sun_path[0] = '\0';
		length = offsetof(struct sockaddr_un, sun_path) + strlen(m->name);
	}
	m->fd = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
	assert_true(m->fd >= 0);
	assert_int_equal(bind(m->fd, (struct sockaddr *)&address, (socklen_t)length), 0);
	setenv("NOTIFY_SOCKET", m->name, 1);
}

static void hang_up(struct manager *m)
{
	close(m->fd);
	if (m->name[0] != '@')
		unlink(m->name);
	rmdir(m->folder);
}

static const char *heard(const struct manager *m)
{
	static char text[512];
	ssize_t got = recv(m->fd, text, sizeof(text) - 1, 0);
	text[got < 0 ? 0 : got] = '\0';
	return text;
}

static void tells_when_it_is_ready_alive_and_stopping(void **state)
{
	(void)state;
	for (int abstract = 0; abstract < 2; abstract++) {
		struct manager m;
		struct notify n;
		listen_at(&m, abstract);
		setenv("WATCHDOG_USEC", "2000000", 1);
		char pid[32];
		snprintf(pid, sizeof(pid), "%ld", (long)getpid());
		setenv("WATCHDOG_PID", pid, 1);
		assert_int_equal(notify_open(&n), 0);
		assert_null(getenv("NOTIFY_SOCKET"));
		assert_null(getenv("WATCHDOG_USEC"));
		assert_null(getenv("WATCHDOG_PID"));
		assert_true(n.beat_ns == NS_PER_S);
		notify_alive(&n, 0);
		assert_string_equal(heard(&m), ""); /* not before it is ready */
		notify_ready(&n, "drawing Rome");
		assert_string_equal(heard(&m), "READY=1\nSTATUS=drawing Rome");
		notify_ready(&n, "again");
		assert_string_equal(heard(&m), "");
		for (int64_t t = 0; t < 3 * NS_PER_S; t += NS_PER_S / 60)
			notify_alive(&n, 5 * NS_PER_S + t);
		for (int i = 0; i < 3; i++)
			assert_string_equal(heard(&m), "WATCHDOG=1");
		assert_string_equal(heard(&m), "");
		notify_status(&n, "no package");
		assert_string_equal(heard(&m), "STATUS=no package");
		notify_close(&n);
		assert_string_equal(heard(&m), "STOPPING=1");
		assert_true(n.lost == 0);
		hang_up(&m);
	}
}

static void is_silent_without_a_manager(void **state)
{
	(void)state;
	struct notify n;
	setenv("WATCHDOG_USEC", "2000000", 1);
	setenv("WATCHDOG_PID", "1", 1); /* another process is watched, not this one */
	assert_int_equal(notify_open(&n), 0);
	assert_true(n.fd == -1 && n.beat_ns == 0);
	notify_ready(&n, NULL);
	notify_alive(&n, NS_PER_S);
	notify_close(&n);
	struct notify zeroed = { 0 };
	notify_close(&zeroed); /* must not close the standard input */
	assert_true(lseek(STDIN_FILENO, 0, SEEK_CUR) >= 0 || errno != EBADF);
}

static void refuses_what_is_no_address(void **state)
{
	(void)state;
	char long_name[200];
	memset(long_name, 'x', sizeof(long_name));
	long_name[0] = '/';
	long_name[sizeof(long_name) - 1] = '\0';
	const struct {
		const char *name;
		int status;
	} cases[] = {
		{ "", -EINVAL },
		{ "relative", -EINVAL },
		{ "/", -EINVAL },
		{ "@", -EINVAL },
		{ long_name, -EINVAL },
		{ "/tmp/nobody/listens/here", -ENOENT },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct notify n;
		setenv("NOTIFY_SOCKET", cases[i].name, 1);
		assert_int_equal(notify_open(&n), cases[i].status);
		assert_int_equal(n.fd, -1);
		notify_ready(&n, NULL);
		notify_close(&n);
	}
}

static void ignores_a_watchdog_time_that_is_none(void **state)
{
	(void)state;
	const char *const periods[] = { "", "0", "-5", "soon", "12x", "99999999999999999999" };
	for (size_t i = 0; i < sizeof(periods) / sizeof(periods[0]); i++) {
		struct notify n;
		setenv("WATCHDOG_USEC", periods[i], 1);
		assert_int_equal(notify_open(&n), 0);
		assert_true(n.beat_ns == 0);
	}
}

static void does_not_wait_for_a_manager_that_does_not_read(void **state)
{
	(void)state;
	struct manager m;
	struct notify n;
	listen_at(&m, true);
	setenv("WATCHDOG_USEC", "2", 1);
	assert_int_equal(notify_open(&n), 0);
	notify_ready(&n, NULL);
	for (int64_t i = 1; i < 10000; i++)
		notify_alive(&n, i * NS_PER_S);
	assert_true(n.lost > 0);
	notify_close(&n);
	hang_up(&m);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tells_when_it_is_ready_alive_and_stopping),
		cmocka_unit_test(is_silent_without_a_manager),
		cmocka_unit_test(refuses_what_is_no_address),
		cmocka_unit_test(ignores_a_watchdog_time_that_is_none),
		cmocka_unit_test(does_not_wait_for_a_manager_that_does_not_read),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
