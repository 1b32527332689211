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

void kms_vt_open(struct kms_vt *vt, const char *name)
{
	*vt = (struct kms_vt){ .fd = -1 };
	if (name && !strcmp(name, "none"))
		return;
	vt->fd = name && strcmp(name, "auto") != 0 ? open(name, O_RDWR | O_CLOEXEC | O_NOCTTY) : open_active();
	if (vt->fd < 0) {
		log_debug("virtual terminals: %s", strerror(errno));
		return;
	}
	catch_signals();
	struct vt_mode mode = { .mode = VT_PROCESS, .relsig = (short)SIGNAL_LEAVE, .acqsig = (short)SIGNAL_ENTER };
	if (ioctl(vt->fd, VT_SETMODE, &mode)) {
		log_debug("virtual terminals: %s", strerror(errno));
		close(vt->fd);
		vt->fd = -1;
		return;
	}
	vt->graphics = ioctl(vt->fd, KDSETMODE, KD_GRAPHICS) == 0; /* no text over the picture */
}

void kms_vt_close(struct kms_vt *vt)
{
	if (vt->fd < 0)
		return;
	struct vt_mode mode = { .mode = VT_AUTO };
	ioctl(vt->fd, VT_SETMODE, &mode);
	if (vt->graphics)
		ioctl(vt->fd, KDSETMODE, KD_TEXT);
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
