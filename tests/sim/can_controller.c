/*
 * A CAN controller that does what it is told: the kernel's own driver for controllers on a serial line (slcan), on a
 * pseudo terminal whose other end is this program. What a virtual bus cannot do, this one can: error frames that the
 * driver makes, states with their counters, bus off with the carrier gone, and an adapter that is pulled out.
 *   can_controller INTERFACE WIRE    makes INTERFACE, down; gone when this program ends
 * What is sent on the interface WIRE, a virtual one, is what the controller hears, unless it is bus off.
 * Lines of the standard input go to the driver as they are (the kernel's drivers/net/can/slcan):
 *   sw096000    state: a active, w warning, p passive, b bus off; errors received and sent, three digits each
 *   e1f         one error: a no answer, b and B bits, c checksum, f form, s stuffing
 */
#include <errno.h>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <poll.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#define LINE_DISCIPLINE 17 /* N_SLCAN of linux/tty.h */

static int fail(const char *what)
{
	fprintf(stderr, "can_controller: %s: %s\n", what, strerror(errno));
	return -1;
}

/* The end of the line that the driver is on. */
static int open_line(int terminal)
{
	if (grantpt(terminal) < 0 || unlockpt(terminal) < 0)
		return fail("pseudo terminal");
	int line = open(ptsname(terminal), O_RDWR | O_NOCTTY | O_CLOEXEC);
	struct termios raw;
	if (line < 0 || tcgetattr(line, &raw) < 0)
		return fail("pseudo terminal");
	cfmakeraw(&raw);
	tcsetattr(line, TCSANOW, &raw);
	return line;
}

/* The driver names its interface itself; it gets the wished name. */
static int attach(int line, const char *name)
{
	int discipline = LINE_DISCIPLINE, to = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
	struct ifreq request = { 0 };
	char made[IFNAMSIZ] = "";
	if (to < 0)
		return fail("socket");
	if (ioctl(line, TIOCSETD, &discipline) < 0 || ioctl(line, SIOCGIFNAME, made) < 0)
		return fail("no slcan in this kernel");
	snprintf(request.ifr_name, sizeof(request.ifr_name), "%s", made);
	snprintf(request.ifr_newname, sizeof(request.ifr_newname), "%s", name);
	int status = ioctl(to, SIOCSIFNAME, &request);
	close(to);
	return status < 0 ? fail(name) : 0;
}

static int open_wire(const char *name)
{
	struct sockaddr_can at = { .can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(name) };
	int wire = socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW);
	if (wire < 0 || !at.can_ifindex || bind(wire, (struct sockaddr *)&at, sizeof(at)) < 0)
		return fail(name);
	return wire;
}

/* One frame of the wire as the driver reads it. */
static int hear(int wire, int terminal)
{
	struct can_frame frame;
	char text[64];
	if (read(wire, &frame, sizeof(frame)) != sizeof(frame))
		return fail("wire");
	bool extended = frame.can_id & CAN_EFF_FLAG;
	int size = snprintf(text, sizeof(text), extended ? "T%08X%u" : "t%03X%u",
		frame.can_id & (extended ? CAN_EFF_MASK : CAN_SFF_MASK), frame.len);
	for (int i = 0; i < frame.len && i < CAN_MAX_DLEN; i++)
		size += snprintf(text + size, sizeof(text) - (size_t)size, "%02X", frame.data[i]);
	text[size++] = '\r';
	return write(terminal, text, (size_t)size) == size ? 0 : fail("pseudo terminal");
}

/* Lines for the driver; returns their number of bytes, 0 at the end. The last state among them decides `off`. */
static ssize_t obey(int terminal, bool *off)
{
	char buffer[512];
	ssize_t size = read(STDIN_FILENO, buffer, sizeof(buffer));
	for (ssize_t i = 0; i < size; i++) {
		if (buffer[i] == 's' && i + 1 < size)
			*off = buffer[i + 1] == 'b';
		buffer[i] = buffer[i] == '\n' ? '\r' : buffer[i];
	}
	if (size > 0 && write(terminal, buffer, (size_t)size) != size)
		return fail("pseudo terminal");
	return size < 0 ? 0 : size;
}

/* What the driver says (its bit rate, frames to be sent) is thrown away. */
static int serve(int terminal, int wire)
{
	struct pollfd wait[] = { { .fd = terminal, .events = POLLIN }, { .fd = STDIN_FILENO, .events = POLLIN },
		{ .fd = wire, .events = POLLIN } };
	char said[512];
	for (bool off = false; poll(wait, 3, -1) > 0;) {
		if (wait[0].revents && read(terminal, said, sizeof(said)) <= 0)
			return fail("pseudo terminal");
		if (wait[1].revents) {
			ssize_t size = obey(terminal, &off);
			if (size < 0)
				return -1;
			wait[1].fd = size ? STDIN_FILENO : -1;
			wait[2].fd = off ? -1 : wire;
		}
		if (wait[2].revents && wait[2].fd >= 0 && hear(wire, terminal) < 0)
			return -1;
	}
	return fail("poll");
}

int main(int count, char **words)
{
	if (count != 3) {
		fprintf(stderr, "usage: can_controller INTERFACE WIRE <COMMANDS\n");
		return 2;
	}
	int terminal = posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC), wire = open_wire(words[2]);
	int line = terminal < 0 ? fail("pseudo terminal") : open_line(terminal);
	if (wire < 0 || line < 0 || attach(line, words[1]) < 0)
		return 1;
	return serve(terminal, wire) < 0;
}
