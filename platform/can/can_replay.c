/* A recorded log as a CAN bus. Its first frame is given the start time and the others keep their distances to it, but
 * for clock steps and long silences (can_bus.h). Lines are parsed when their time has come, one ahead. */
#include <errno.h>
#include <string.h>

#include "platform/can/can_bus.h"
#include "platform/can/log_stream.h"

#define TEXT_SIZE (1 << 16)
#define MAX_GAP_NS (60 * INT64_C(1000000000))

struct can_replay {
	struct can_bus bus; /* first: a can_bus of ours is one of these */
	struct log_stream stream;
	int64_t max_gap_ns;
	int64_t log_ns;   /* time of the last frame as the log has it */
	int64_t shift_ns; /* replay time - log time */
	bool waiting;     /* `next` holds a frame that was not handed out yet */
	bool skipping;    /* inside a line that is too long */
	bool text_ended;
	struct can_frame_rx next;
	size_t text_at, text_end;
	char text[TEXT_SIZE];
};

static void note_bad(struct can_replay *replay, const char *why)
{
	struct can_bus_stats *stats = &replay->bus.stats;
	if (!stats->bad++) {
		stats->bad_first = stats->lines;
		stats->bad_why = why;
	}
}

/* Moves what is left to the front and reads more. Returns false at the end of the file. */
static bool refill(struct can_replay *replay)
{
	size_t left = replay->text_end - replay->text_at;
	memmove(replay->text, replay->text + replay->text_at, left);
	replay->text_at = 0;
	replay->text_end = left;
	size_t n = log_stream_read(&replay->stream, (uint8_t *)replay->text + left, TEXT_SIZE - left);
	replay->text_end += n;
	return n > 0;
}

/* The next line without its newline; false at the end. A last line without newline counts too. */
static bool next_line(struct can_replay *replay, const char **line, size_t *length)
{
	for (;;) {
		char *start = replay->text + replay->text_at;
		size_t have = replay->text_end - replay->text_at;
		char *end = memchr(start, '\n', have);
		bool whole = end != NULL;
		if (!whole && have < TEXT_SIZE && !replay->text_ended) {
			replay->text_ended = !refill(replay);
			continue;
		}
		if (!whole && have == 0)
			return false;
		*line = start;
		*length = whole ? (size_t)(end - start) : have;
		replay->text_at += *length + whole;
		bool tail = replay->skipping; /* of a line that did not fit into the buffer; its head was counted */
		replay->skipping = !whole && !replay->text_ended;
		if (tail)
			continue;
		replay->bus.stats.lines++;
		return true;
	}
}

static bool is_blank(const char *line, size_t length)
{
	while (length && (line[length - 1] == ' ' || line[length - 1] == '\t' || line[length - 1] == '\r'))
		length--;
	return length == 0;
}

/* Log time -> replay time. */
static int64_t place_in_time(struct can_replay *replay, int64_t log_ns)
{
	struct can_bus_stats *stats = &replay->bus.stats;
	int64_t step = log_ns - replay->log_ns;
	if (step < 0) {
		stats->steps_back++;
		if (step > -CAN_STEP_NS) /* interfaces interleave a little out of order */
			return replay->log_ns + replay->shift_ns;
		replay->shift_ns -= step;
	} else if (step > replay->max_gap_ns) {
		stats->gaps++;
		replay->shift_ns -= step - replay->max_gap_ns;
	}
	replay->log_ns = log_ns;
	return log_ns + replay->shift_ns;
}

/* Parses on until a frame is waiting. Returns false at the end. */
static bool look_ahead(struct can_replay *replay)
{
	const char *line;
	size_t length;
	struct candump_record record;
	while (!replay->waiting) {
		if (!next_line(replay, &line, &length))
			return false;
		if (is_blank(line, length))
			continue;
		const char *why = candump_parse(line, length, &record);
		if (why) {
			note_bad(replay, why);
			continue;
		}
		record.frame.bus = can_bus_index_or_add(&replay->bus, record.interface);
		if (record.frame.bus == CAN_BUS_NONE) {
			replay->bus.stats.dropped++;
			continue;
		}
		replay->next = record.frame;
		replay->waiting = true;
	}
	return true;
}

static int replay_read(struct can_bus *bus, int64_t until_ns, struct can_frame_rx *frames, int capacity)
{
	struct can_replay *replay = (struct can_replay *)bus;
	int count = 0;
	while (count < capacity) {
		bool fresh = !replay->waiting;
		if (!look_ahead(replay)) {
			bus->ended = true;
			bus->stats.cut = replay->stream.cut;
			return count || !replay->stream.error ? count : replay->stream.error;
		}
		if (fresh)
			replay->next.time_ns = place_in_time(replay, replay->next.time_ns);
		if (replay->next.time_ns > until_ns)
			return count;
		bus->wall_offset_ns = -replay->shift_ns;
		can_bus_note_frame(bus, &replay->next);
		frames[count++] = replay->next;
		replay->waiting = false;
	}
	return count;
}

static void replay_close(struct can_bus *bus)
{
	log_stream_close(&((struct can_replay *)bus)->stream);
}

static int start(struct can_replay *replay, const struct can_bus_config *config)
{
	for (unsigned i = 0; i < config->interface_count; i++)
		can_bus_index_or_add(&replay->bus, config->interfaces[i]);
	if (!look_ahead(replay))
		return replay->stream.error ? replay->stream.error : -ENODATA;
	replay->log_ns = replay->next.time_ns;
	replay->shift_ns = config->start_ns - replay->log_ns;
	replay->next.time_ns = config->start_ns;
	replay->bus.wall_offset_ns = -replay->shift_ns;
	return 0;
}

static int replay_open(const struct can_bus_config *config, struct arena *arena, struct can_bus **out)
{
	size_t mark = arena_mark(arena);
	struct can_replay *replay = ARENA_ARRAY(arena, struct can_replay, 1);
	if (!replay)
		return -ENOMEM;
	replay->bus.ops = &can_replay_ops;
	replay->bus.last_ns = config->start_ns;
	replay->max_gap_ns = config->max_gap_ns > 0 ? config->max_gap_ns : MAX_GAP_NS;
	int status = log_stream_open(&replay->stream, config->path, arena);
	if (status)
		goto err_release;
	status = start(replay, config);
	if (status)
		goto err_close;
	*out = &replay->bus;
	return 0;
err_close:
	log_stream_close(&replay->stream);
err_release:
	arena_release(arena, mark);
	return status;
}

const struct can_bus_ops can_replay_ops = {
	.name = "replay",
	.open = replay_open,
	.read = replay_read,
	.close = replay_close,
};
