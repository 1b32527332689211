/*
 * A log of what gpsd said (gpspipe -w), a line at a time: each is heard when its own time has come, so that a log of a
 * drive replays beside the drive's CAN log. The file stays in the address space.
 */
#include <errno.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/file_map.h"
#include "platform/base/log.h"
#include "platform/gnss/gnss.h"

struct gnss_log {
	struct gnss gnss; /* first: a gnss of ours is one of these */
	struct file_map map;
	size_t at;
	int64_t wall_offset_ns;
	bool has_offset, has_next;
	struct gnss_fix next;
};

/* Finds the next fix with a time. */
static void find_next(struct gnss_log *log)
{
	while (!log->has_next && log->at < log->map.bytes.size) {
		const char *line = (const char *)log->map.bytes.data + log->at;
		size_t left = log->map.bytes.size - log->at;
		const char *end = memchr(line, '\n', left);
		size_t size = end ? (size_t)(end - line) : left;
		log->at += size + (end != NULL);
		log->gnss.stats.lines++;
		log->gnss.stats.bad += size > 0 && line[0] != '{';
		log->has_next = gnss_parse(line, size, &log->next) == GNSS_LINE_FIX && log->next.utc_ns > 0;
	}
	if (!log->has_next)
		log->gnss.state = GNSS_ENDED;
}

static bool log_read(struct gnss *gnss, int64_t now_ns, struct gnss_fix *out)
{
	struct gnss_log *log = (struct gnss_log *)gnss;
	bool any = false;
	for (find_next(log); log->has_next; find_next(log)) {
		if (!log->has_offset) {
			log->wall_offset_ns = log->next.utc_ns - now_ns;
			log->has_offset = true;
		}
		int64_t time_ns = log->next.utc_ns - log->wall_offset_ns;
		if (time_ns > now_ns)
			break;
		*out = log->next;
		out->time_ns = time_ns;
		log->has_next = false;
		gnss->state = GNSS_GOOD;
		gnss->stats.fixes++;
		any = true;
	}
	return any;
}

static void log_close(struct gnss *gnss)
{
	file_map_close(&((struct gnss_log *)gnss)->map);
}

static int log_open(const struct gnss_config *config, struct arena *arena, struct gnss **out)
{
	struct gnss_log *made = ARENA_ARRAY(arena, struct gnss_log, 1);
	if (!made)
		return -ENOMEM;
	int status = file_map_open(&made->map, config->source);
	if (status) {
		log_error("%s: %s", config->source, strerror(-status));
		return status;
	}
	made->gnss.ops = &gnss_log_ops;
	made->gnss.state = GNSS_WAITING;
	made->wall_offset_ns = config->wall_offset_ns;
	made->has_offset = config->wall_offset_ns != 0;
	*out = &made->gnss;
	return 0;
}

const struct gnss_ops gnss_log_ops = {
	.name = "log",
	.open = log_open,
	.read = log_read,
	.close = log_close,
};
