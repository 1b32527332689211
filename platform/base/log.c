#include "platform/base/log.h"

#include <stdarg.h>
#include <stdio.h>
#include <unistd.h>

static const char *program_name = "boulevard";
static enum log_level threshold = LOG_INFO;

void log_init(const char *program, enum log_level max_level)
{
	program_name = program;
	threshold = max_level;
}

void log_line(enum log_level level, const char *format, ...)
{
	static const char *const words[] = { "error: ", "warning: ", "", "debug: " };
	if (level > threshold)
		return;
	char line[1024];
	int used = snprintf(line, sizeof(line), "%s: %s", program_name, words[level]);
	if (used < 0)
		return;
	va_list args;
	va_start(args, format);
	int more = vsnprintf(line + used, sizeof(line) - (size_t)used - 1, format, args);
	va_end(args);
	if (more > 0)
		used += more;
	if (used > (int)sizeof(line) - 2)
		used = (int)sizeof(line) - 2;
	line[used] = '\n';
	ssize_t ignored = write(STDERR_FILENO, line, (size_t)used + 1);
	(void)ignored;
}
