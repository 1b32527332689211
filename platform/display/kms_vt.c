/*
 * Virtual terminals: the one that we stand on tells us by two signals when another one is asked for and when ours is
 * back. Where there are none (most boards without a keyboard) or we may not open them, nothing is lost.
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/kd.h>
#include <linux/vt.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/sysmacros.h>
#include <termios.h>
#include <unistd.h>

#include "platform/base/log.h"
#include "platform/display/kms.h"

/* SIGUSR1 and SIGUSR2, the usual ones, are the main program's. */
#define SIGNAL_LEAVE (SIGRTMIN + 4)
#define SIGNAL_ENTER (SIGRTMIN + 5)

static volatile sig_atomic_t leave_asked, enter_asked;

static void on_signal(int number)
{
	if (number == SIGNAL_LEAVE)
		leave_asked = 1;
	else
		enter_asked = 1;
}

static void catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_signal, .sa_flags = SA_RESTART };
	sigemptyset(&action.sa_mask);
	sigaction(SIGNAL_LEAVE, &action, NULL);
	sigaction(SIGNAL_ENTER, &action, NULL);
	leave_asked = enter_asked = 0;
}

/* The active terminal. */
static int open_active(void)
{
	struct vt_stat state;
	char path[32];
	int fd = open("/dev/tty0", O_RDWR | O_CLOEXEC | O_NOCTTY);
	if (fd < 0)
		return -1;
	int err = ioctl(fd, VT_GETSTATE, &state);
	close(fd);
	if (err)
		return -1;
	snprintf(path, sizeof(path), "/dev/tty%u", state.v_active);
	return open(path, O_RDWR | O_CLOEXEC | O_NOCTTY);
}

/* Whoever was started on a terminal, by hand or by a unit with TTYPath=, stands on it. Needs no right. */
static int open_own(void)
{
	struct vt_stat state;
	return ioctl(STDIN_FILENO, VT_GETSTATE, &state) ? -1 : fcntl(STDIN_FILENO, F_DUPFD_CLOEXEC, 0);
}

/* Signals instead of switches. Returns 0 or -errno. */
static int take_switches(int fd)
{
	struct vt_mode mode = { .mode = VT_PROCESS, .relsig = (short)SIGNAL_LEAVE, .acqsig = (short)SIGNAL_ENTER };
	catch_signals();
	return ioctl(fd, VT_SETMODE, &mode) ? -errno : 0;
}

/* Number of the terminal; 0 unknown. */
static unsigned number_of(int fd)
{
	unsigned device = 0;
	return ioctl(fd, TIOCGDEV, &device) ? 0 : minor(device);
}

/* Behind another terminal: to the front, unless a program was killed there, whose place we take. Somebody is looking at
 * something else then. */
static void come_to_front(struct kms_vt *vt, bool was_graphics)
{
	struct vt_stat state;
	unsigned number = number_of(vt->fd);
	vt->away = number && !ioctl(vt->fd, VT_GETSTATE, &state) && state.v_active != number;
	if (vt->away && !was_graphics && ioctl(vt->fd, VT_ACTIVATE, number))
		log_warn("tty%u cannot come to the front: %s", number, strerror(errno));
}

void kms_vt_open(struct kms_vt *vt, const char *name)
{
	*vt = (struct kms_vt){ .fd = -1 };
	bool named = name && strcmp(name, "auto") != 0;
	if (named && !strcmp(name, "none"))
		return;
	vt->fd = named ? open(name, O_RDWR | O_CLOEXEC | O_NOCTTY) : open_own();
	if (vt->fd < 0 && !named)
		vt->fd = open_active();
	int err = vt->fd < 0 ? -errno : take_switches(vt->fd);
	if (err) {
		log_line(named ? LOG_WARN : LOG_DEBUG, "%s: %s; terminals are left alone", named ? name : "terminal",
			strerror(-err));
		if (vt->fd >= 0)
			close(vt->fd);
		vt->fd = -1;
		return;
	}
	int shows = KD_TEXT;
	ioctl(vt->fd, KDGETMODE, &shows);
	vt->graphics = ioctl(vt->fd, KDSETMODE, KD_GRAPHICS) == 0; /* no text over the picture */
	come_to_front(vt, shows == KD_GRAPHICS);
}

void kms_vt_close(struct kms_vt *vt)
{
	if (vt->fd < 0)
		return;
	if (leave_asked) /* by somebody who waits */
		ioctl(vt->fd, VT_RELDISP, 1);
	struct vt_mode mode = { .mode = VT_AUTO };
	ioctl(vt->fd, VT_SETMODE, &mode);
	if (vt->graphics)
		ioctl(vt->fd, KDSETMODE, KD_TEXT);
	tcflush(vt->fd, TCIFLUSH); /* what was typed in the meantime was not meant for the shell */
	close(vt->fd);
	*vt = (struct kms_vt){ .fd = -1 };
}

enum kms_vt_change kms_vt_poll(struct kms_vt *vt)
{
	if (vt->fd < 0)
		return KMS_VT_SAME;
	if (leave_asked) {
		leave_asked = 0;
		return KMS_VT_LEAVING;
	}
	if (enter_asked) {
		enter_asked = 0;
		ioctl(vt->fd, VT_RELDISP, VT_ACKACQ);
		vt->away = false;
		return KMS_VT_ENTERED;
	}
	return KMS_VT_SAME;
}

void kms_vt_leave(struct kms_vt *vt)
{
	vt->away = true;
	ioctl(vt->fd, VT_RELDISP, 1);
}
