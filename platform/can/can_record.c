#include "platform/can/can_record.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/base/worker.h"

#define RING_FRAMES 16384 /* two seconds of a full bus */
#define NAMES_MAX 16
#define TEXT_SIZE (1 << 16)
#define WRITE_NS (500 * NS_PER_MS) /* longest that a line waits for the next */
#define RETRY_NS NS_PER_S

struct can_record {
	struct worker thread;
	struct can_record_config config;
	char old_path[PATH_MAX];

	pthread_mutex_t mutex; /* guards what follows to `ring`; never held while writing */
	pthread_cond_t more, less;
	bool stop;
	struct can_record_stats stats;
	char names[NAMES_MAX][CANDUMP_NAME_SIZE];
	uint32_t first, count;
	struct can_frame_rx ring[RING_FRAMES];

	/* the writing thread's own */
	int fd; /* -1: could not be opened again after the last turn */
	uint64_t file_bytes;
	uint32_t text_lines;
	size_t text_used;
	char text[TEXT_SIZE];
};

static void note_error(struct can_record *record, int status)
{
	pthread_mutex_lock(&record->mutex);
	bool first = !record->stats.error;
	if (first)
		record->stats.error = status;
	pthread_mutex_unlock(&record->mutex);
	if (first)
		log_error("%s: cannot write: %s; the drive goes on, trying again", record->config.path, strerror(-status));
}

static int open_file(struct can_record *record)
{
	record->fd = open(record->config.path, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
	record->file_bytes = 0;
	return record->fd < 0 ? -errno : 0;
}

static int turn(struct can_record *record)
{
	if (record->fd >= 0)
		close(record->fd);
	record->fd = -1;
	if (rename(record->config.path, record->old_path) < 0 && errno != ENOENT)
		return -errno;
	return open_file(record);
}

/* All of the text or, to the reader of the file, nothing of it. */
static int write_text(struct can_record *record)
{
	size_t done = 0;
	while (done < record->text_used) {
		ssize_t n = write(record->fd, record->text + done, record->text_used - done);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0) {
			int status = n < 0 ? -errno : -EIO;
			if (done && (ftruncate(record->fd, (off_t)record->file_bytes) < 0 ||
							lseek(record->fd, (off_t)record->file_bytes, SEEK_SET) < 0))
				log_debug("%s: a line may be cut: %s", record->config.path, strerror(errno)); /* a pipe */
			return status;
		}
		done += (size_t)n;
	}
	record->file_bytes += done;
	return 0;
}

/* Returns 0 when the text is in the file. */
static int put_text(struct can_record *record)
{
	int status = 0;
	uint64_t half = record->config.limit_bytes / 2;
	if (record->fd < 0)
		status = open_file(record);
	else if (half && record->file_bytes && record->file_bytes + record->text_used > half)
		status = turn(record);
	if (!status)
		status = write_text(record);
	if (status) {
		note_error(record, status);
		return status;
	}
	pthread_mutex_lock(&record->mutex);
	record->stats.lines += record->text_lines;
	record->stats.bytes += record->text_used;
	pthread_mutex_unlock(&record->mutex);
	record->text_used = record->text_lines = 0;
	return 0;
}

/* Waits until there is something to write, for some time or the end, and takes it out of the ring. Holds the mutex. */
static void take_lines(struct can_record *record)
{
	while (record->count && record->text_used + CANDUMP_LINE_SIZE <= TEXT_SIZE) {
		const struct can_frame_rx *frame = &record->ring[record->first];
		record->text_used += candump_format(record->names[frame->bus], frame, record->text + record->text_used);
		record->text_lines++;
		record->first = (record->first + 1) % RING_FRAMES;
		record->count--;
	}
	pthread_cond_signal(&record->less);
}

static void wait_until(struct can_record *record, int64_t wait_ns)
{
	int64_t until_ns = clock_now_ns() + wait_ns;
	struct timespec until = { .tv_sec = (time_t)(until_ns / NS_PER_S), .tv_nsec = (long)(until_ns % NS_PER_S) };
	while (!record->stop && record->count < RING_FRAMES / 2)
		if (pthread_cond_clockwait(&record->more, &record->mutex, CLOCK_MONOTONIC, &until) == ETIMEDOUT)
			break;
}

/* After a fault the whole second is waited for, however full the ring is. */
static void wait_to_retry(struct can_record *record)
{
	int64_t until_ns = clock_now_ns() + RETRY_NS;
	struct timespec until = { .tv_sec = (time_t)(until_ns / NS_PER_S), .tv_nsec = (long)(until_ns % NS_PER_S) };
	while (!record->stop && pthread_cond_clockwait(&record->more, &record->mutex, CLOCK_MONOTONIC, &until) != ETIMEDOUT)
		;
}

static void work(void *context, uint32_t job)
{
	struct can_record *record = context;
	bool failed = false, stop = false;
	(void)job;
	while (!stop) {
		pthread_mutex_lock(&record->mutex);
		if (failed)
			wait_to_retry(record);
		else
			wait_until(record, WRITE_NS);
		stop = record->stop;
		take_lines(record);
		pthread_mutex_unlock(&record->mutex);
		failed = record->text_used && put_text(record) < 0;
	}
	for (; !failed && record->count; failed = put_text(record) < 0)
		take_lines(record); /* nobody else is left to add any */
	record->stats.lost += record->count + record->text_lines;
}

int can_record_open(struct can_record **out, const struct can_record_config *config, struct arena *arena)
{
	size_t mark = arena_mark(arena);
	struct can_record *made = ARENA_ARRAY(arena, struct can_record, 1);
	if (!made)
		return -ENOMEM;
	made->config = *config;
	int status = snprintf(made->old_path, sizeof(made->old_path), "%s.1", config->path);
	status = status >= (int)sizeof(made->old_path) ? -ENAMETOOLONG : open_file(made);
	if (status)
		goto err_release;
	pthread_mutex_init(&made->mutex, NULL);
	pthread_cond_init(&made->more, NULL);
	pthread_cond_init(&made->less, NULL);
	status = worker_init(&made->thread, "record", work, made);
	if (status)
		goto err_close;
	worker_give(&made->thread, 0);
	*out = made;
	return 0;
err_close:
	close(made->fd);
	pthread_cond_destroy(&made->less);
	pthread_cond_destroy(&made->more);
	pthread_mutex_destroy(&made->mutex);
err_release:
	arena_release(arena, mark);
	return status;
}

void can_record_add(struct can_record *record, const char *name, const struct can_frame_rx *frame)
{
	pthread_mutex_lock(&record->mutex);
	while (record->config.wait && record->count == RING_FRAMES && !record->stats.error) {
		pthread_cond_signal(&record->more);
		pthread_cond_wait(&record->less, &record->mutex);
	}
	if (record->count == RING_FRAMES || frame->bus >= NAMES_MAX || frame->time_ns < 0) {
		record->stats.lost++;
	} else {
		char *known = record->names[frame->bus];
		if (!known[0])
			snprintf(known, CANDUMP_NAME_SIZE, "%s", name);
		record->ring[(record->first + record->count++) % RING_FRAMES] = *frame;
		if (record->count == RING_FRAMES / 2)
			pthread_cond_signal(&record->more);
	}
	pthread_mutex_unlock(&record->mutex);
}

void can_record_stats(struct can_record *record, struct can_record_stats *out)
{
	pthread_mutex_lock(&record->mutex);
	*out = record->stats;
	pthread_mutex_unlock(&record->mutex);
}

int can_record_close(struct can_record *record)
{
	if (!record)
		return 0;
	pthread_mutex_lock(&record->mutex);
	record->stop = true;
	pthread_cond_signal(&record->more);
	pthread_mutex_unlock(&record->mutex);
	uint32_t job;
	worker_take(&record->thread, true, &job);
	worker_finish(&record->thread);
	int status = record->stats.lost ? record->stats.error : 0;
	if (record->fd >= 0 && close(record->fd) < 0 && !status)
		status = -errno;
	pthread_cond_destroy(&record->less);
	pthread_cond_destroy(&record->more);
	pthread_mutex_destroy(&record->mutex);
	return status;
}
