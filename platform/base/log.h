/*
 * One line a message on stderr: "boulevard: warning: ...". Level and program name are set once at
 * start. Thread safe (one write per line).
 */
#ifndef BLVD_PLATFORM_BASE_LOG_H
#define BLVD_PLATFORM_BASE_LOG_H

/* LOG_NONE is for log_init() alone. */
enum log_level { LOG_NONE = -1, LOG_ERROR, LOG_WARN, LOG_INFO, LOG_DEBUG };

/* `program` is borrowed and must outlive all logging. */
void log_init(const char *program, enum log_level max_level);

void log_line(enum log_level level, const char *format, ...) __attribute__((format(printf, 2, 3)));

#define log_error(...) log_line(LOG_ERROR, __VA_ARGS__)
#define log_warn(...) log_line(LOG_WARN, __VA_ARGS__)
#define log_info(...) log_line(LOG_INFO, __VA_ARGS__)
#define log_debug(...) log_line(LOG_DEBUG, __VA_ARGS__)

#endif
