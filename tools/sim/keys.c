#include "tools/sim/keys.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

const char *const keys_help =
	"arrows      faster, slower, steer     space  stop          p r n d  gear\n"
	", . /       lamp left, right, hazard  i      ignition      l        dark or light\n"
	"1 to 9      faults, see below         0      all is well   :        a command in words; ? for these\n"
	"1 no speed   2 turn rate stuck   3 steering noisy   4 speed out of range   5 counter   6 checksum\n"
	"7 bus off    8 camera frozen     9 reverse line chatters       each for some seconds    q  quit\n";

static const struct {
	char key;
	const char *command;
} table[] = {
	{ 'p', "gear P" },
	{ 'r', "gear R" },
	{ 'n', "gear N" },
	{ 'd', "gear D" },
	{ ' ', "stop" },
	{ ',', "lamp left" },
	{ '.', "lamp right" },
	{ '/', "lamp hazard" },
	{ 'h', "lamp hazard" },
	{ 'i', "ignition" },
	{ '1', "lost:speed/8" },
	{ '2', "stuck:yaw_rate/8" },
	{ '3', "noisy:steering/8" },
	{ '4', "range:speed/8" },
	{ '5', "counter:speed/8" },
	{ '6', "checksum:speed/8" },
	{ '7', "busoff/8" },
	{ '8', "camera:frozen/5" },
	{ '9', "chatter:reverse/2" },
	{ '0', "clear" },
	{ 'q', "quit" },
	{ 3, "quit" }, /* ^C */
	{ 'w', "faster" },
	{ 's', "slower" },
	{ 'a', "left" },
	{ 'e', "right" },
};

static struct termios before; /* of the one terminal there is */

void keys_open(struct keys *keys)
{
	*keys =
		(struct keys){ .in = STDIN_FILENO, .terminal = isatty(STDIN_FILENO) && tcgetattr(STDIN_FILENO, &before) == 0 };
	int flags = fcntl(STDIN_FILENO, F_GETFL);
	if (flags < 0) { /* there is no standard input */
		keys->in = -1;
		return;
	}
	fcntl(STDIN_FILENO, F_SETFL, flags | O_NONBLOCK);
	if (!keys->terminal)
		return;
	struct termios raw = before;
	raw.c_lflag &= ~(tcflag_t)(ICANON | ECHO);
	raw.c_cc[VMIN] = 0;
	raw.c_cc[VTIME] = 0;
	tcsetattr(STDIN_FILENO, TCSANOW, &raw);
}

void keys_close(struct keys *keys)
{
	int flags = fcntl(STDIN_FILENO, F_GETFL);
	if (flags >= 0)
		fcntl(STDIN_FILENO, F_SETFL, flags & ~O_NONBLOCK);
	if (keys->terminal) {
		tcsetattr(STDIN_FILENO, TCSANOW, &before);
		fputs("\r\033[K", stderr);
	}
	keys->in = -1;
}

static const char *key_command(char key)
{
	for (size_t i = 0; i < sizeof(table) / sizeof(table[0]); i++)
		if (table[i].key == key)
			return table[i].command;
	return NULL;
}

/* "ESC [ A" and "ESC O A"; longer ones, of other keys, are passed over to their last letter. */
static const char *take_escape(struct keys *keys, char c)
{
	static const char letters[] = "ABCD";
	static const char *const commands[] = { "faster", "slower", "right", "left" };
	size_t place = keys->escape_length++;
	if (place == 0 || (place == 1 && (c == '[' || c == 'O')))
		return NULL;
	const char *at = place == 2 && c ? strchr(letters, c) : NULL;
	if (place == 1 || (c >= '@' && c <= '~'))
		keys->escape_length = 0;
	return at ? commands[at - letters] : NULL;
}

/* A whole line, or NULL. */
static const char *take_typed(struct keys *keys, char c)
{
	if (c == '\n' || c == '\r') {
		keys->line[keys->length] = 0;
		keys->length = 0;
		keys->typing = false;
		return keys->line;
	}
	if ((c == 127 || c == 8) && keys->length > 0)
		keys->length--;
	else if (c == 27 && keys->terminal)
		keys->typing = false;
	else if (c >= ' ' && keys->length + 1 < sizeof(keys->line))
		keys->line[keys->length++] = c;
	return NULL;
}

static const char *take_key(struct keys *keys, char c)
{
	if (keys->escape_length > 0 || c == 27)
		return take_escape(keys, c);
	if (keys->typing)
		return take_typed(keys, c);
	if (c == ':') {
		keys->typing = true;
		keys->length = 0;
		return NULL;
	}
	if (c == '?')
		fprintf(stderr, "\r\033[K%s", keys_help);
	return key_command(c);
}

const char *keys_next(struct keys *keys)
{
	char c;
	while (keys->in >= 0) {
		ssize_t n = read(keys->in, &c, 1);
		if (n == 0 && !keys->terminal)
			keys->in = -1; /* the end of a file or a pipe: the drive goes on */
		if (n <= 0)
			return NULL;
		const char *command = keys->terminal ? take_key(keys, c) : take_typed(keys, c);
		if (command)
			return command;
	}
	return NULL;
}

void keys_show(const struct keys *keys, const char *status)
{
	struct winsize size = { 0 };
	if (!keys->terminal)
		return;
	if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) < 0 || size.ws_col < 20)
		size.ws_col = 80;
	if (keys->typing)
		fprintf(stderr, "\r\033[K:%.*s", (int)keys->length, keys->line);
	else
		fprintf(stderr, "\r\033[K%.*s", size.ws_col - 1, status);
	fflush(stderr);
}
