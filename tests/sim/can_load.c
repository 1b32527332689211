/*
 * A full bus: sends numbered frames at a steady rate, and counts in a recording which of them are missing.
 *   can_load INTERFACE RATE SECONDS     identifiers 600 to 6FF; prints how many were sent
 *   can_load --play LOG INTERFACE       a log, again and again, at its pace whatever the wall clock is set to
 *   can_load --check LOG...             in the order of time; prints lines, and numbers that are missing or doubled
 */
#include <errno.h>
#include <linux/can.h>
#include <linux/can/raw.h>
#include <net/if.h>
#include <sched.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/can/can_bus.h"

#define FIRST_ID 0x600u
#define ID_MASK 0x700u

#define BURST_S 0.1
#define PRIORITY 50
#define BATCH 64

/* A bus does not wait for the processor. Without the right to it, it has to. */
static void go_before_others(void)
{
	struct sched_param param = { .sched_priority = PRIORITY };
	if (sched_setscheduler(0, SCHED_FIFO, &param) < 0)
		fprintf(stderr, "can_load: no real-time priority: %s\n", strerror(errno));
}

/* Frame number `number` of the load. */
static struct can_frame numbered(uint32_t number)
{
	struct can_frame frame = { .can_id = FIRST_ID | (number & 0xFF), .can_dlc = 8 };
	memcpy(frame.data, &number, sizeof(number));
	return frame;
}

/* Up to BATCH frames from `number` in one call of the kernel: a call a frame costs an emulated processor more than the
 * frames do. Returns how many were taken, or -errno. */
static int send_batch(int fd, uint32_t number, uint32_t count)
{
	struct can_frame frames[BATCH];
	struct iovec parts[BATCH];
	struct mmsghdr messages[BATCH] = { 0 };
	count = count < BATCH ? count : BATCH;
	for (uint32_t i = 0; i < count; i++) {
		frames[i] = numbered(number + i);
		parts[i] = (struct iovec){ .iov_base = &frames[i], .iov_len = sizeof(frames[i]) };
		messages[i].msg_hdr = (struct msghdr){ .msg_iov = &parts[i], .msg_iovlen = 1 };
	}
	int taken = sendmmsg(fd, messages, count, 0);
	return taken < 0 ? -errno : taken;
}

/* After a pause that was not ours (the machine did something else) the rate goes on: no bus makes up for lost time. */
static int send_all(int fd, double rate, double seconds)
{
	uint32_t sent = 0, total = (uint32_t)(rate * seconds), waits = 0;
	int64_t start_ns = clock_now_ns(), paused_ns = 0;
	while (sent < total) {
		int64_t now_ns = clock_now_ns();
		uint32_t due = (uint32_t)((double)(now_ns - start_ns - paused_ns) * rate / 1e9);
		if (due - sent > rate * BURST_S) {
			paused_ns += (int64_t)((due - sent - rate * BURST_S) / rate * 1e9);
			due = sent + (uint32_t)(rate * BURST_S);
		}
		due = due < total ? due : total;
		while (sent < due) {
			int taken = send_batch(fd, sent, due - sent);
			if (taken == -ENOBUFS) {
				waits++;
				clock_sleep_until(clock_now_ns() + NS_PER_MS / 4);
			} else if (taken < 0) {
				fprintf(stderr, "can_load: cannot send: %s\n", strerror(-taken));
				return 1;
			} else {
				sent += (uint32_t)taken;
			}
		}
		clock_sleep_until(now_ns + NS_PER_MS);
	}
	double took_s = (double)(clock_now_ns() - start_ns) / 1e9;
	printf("{\"sent\": %u, \"seconds\": %.2f, \"rate\": %.0f, \"waits\": %u, \"paused_ms\": %.0f, \"cpu_ms\": %.0f}\n",
		sent, took_s, sent / took_s, waits, (double)paused_ns / 1e6, (double)clock_cpu_ns() / 1e6);
	return 0;
}

/* A socket that sends on the interface and hears nothing, or -1 after a message. */
static int open_sender(const char *interface)
{
	struct sockaddr_can address = { .can_family = AF_CAN, .can_ifindex = (int)if_nametoindex(interface) };
	int fd = address.can_ifindex ? socket(PF_CAN, SOCK_RAW | SOCK_CLOEXEC, CAN_RAW) : -1;
	if (fd >= 0 && !setsockopt(fd, SOL_CAN_RAW, CAN_RAW_FILTER, NULL, 0) &&
		!bind(fd, (const struct sockaddr *)&address, sizeof(address)))
		return fd;
	fprintf(stderr, "can_load: %s: %s\n", interface, strerror(errno));
	if (fd >= 0)
		close(fd);
	return -1;
}

static struct can_bus *open_bus(const char *interface)
{
	static _Alignas(64) uint8_t memory[1 << 20];
	const struct can_bus_filter none = { .id = 0 };
	struct can_bus_config config = {
		.interfaces = &interface, .interface_count = 1, .filters = &none, .filter_count = 1
	};
	struct arena arena;
	struct can_bus *bus;
	arena_init(&arena, "load", memory, sizeof(memory));
	bool local = strchr(interface, ':') != NULL;
	int status = can_bus_open(&bus, local ? &can_socket_ops : &can_socketcan_ops, &config, &arena);
	if (!status)
		return bus;
	fprintf(stderr, "can_load: %s: %s\n", interface, strerror(-status));
	return NULL;
}

/* Once through the log. Returns 1 when it cannot be read or sent. */
static int play_once(struct can_bus *bus, FILE *log)
{
	char line[CANDUMP_LINE_SIZE];
	int64_t start_ns = clock_now_ns(), first_ns = -1;
	while (fgets(line, sizeof(line), log)) {
		struct candump_record record;
		if (candump_parse(line, strcspn(line, "\n"), &record))
			continue;
		if (first_ns < 0)
			first_ns = record.frame.time_ns;
		clock_sleep_until(start_ns + record.frame.time_ns - first_ns);
		int status = can_bus_write(bus, &record.frame);
		if (status < 0 && status != -ENOBUFS) {
			fprintf(stderr, "can_load: cannot send: %s\n", strerror(-status));
			return 1;
		}
	}
	rewind(log);
	return first_ns < 0;
}

static int play(const char *interface, const char *path)
{
	struct can_bus *bus = open_bus(interface);
	FILE *log = fopen(path, "r");
	int status = !bus || !log;
	if (!log)
		fprintf(stderr, "can_load: %s: %s\n", path, strerror(errno));
	while (!status)
		status = play_once(bus, log);
	if (log)
		fclose(log);
	can_bus_close(bus);
	return status;
}

static int load(const char *interface, double rate, double seconds)
{
	int fd = open_sender(interface);
	if (fd < 0)
		return 1;
	go_before_others();
	int status = send_all(fd, rate, seconds);
	close(fd);
	return status;
}

struct count {
	uint64_t lines, numbered, missing, doubled;
	uint32_t next;
};

static int check_file(const char *path, struct count *count)
{
	char line[CANDUMP_LINE_SIZE];
	FILE *file = fopen(path, "r");
	if (!file) {
		fprintf(stderr, "can_load: %s: %s\n", path, strerror(errno));
		return 1;
	}
	while (fgets(line, sizeof(line), file)) {
		struct candump_record record;
		uint32_t number;
		count->lines++;
		if (candump_parse(line, strcspn(line, "\n"), &record) || (record.frame.id & ID_MASK) != FIRST_ID)
			continue;
		memcpy(&number, record.frame.data, sizeof(number));
		count->numbered++;
		if (number < count->next)
			count->doubled++;
		else
			count->missing += number - count->next;
		count->next = number + 1;
	}
	fclose(file);
	return 0;
}

int main(int argc, char **argv)
{
	if (argc >= 3 && !strcmp(argv[1], "--check")) {
		struct count count = { 0 };
		for (int i = 2; i < argc; i++)
			if (check_file(argv[i], &count))
				return 1;
		printf("{\"lines\": %llu, \"numbered\": %llu, \"missing\": %llu, \"doubled\": %llu}\n",
			(unsigned long long)count.lines, (unsigned long long)count.numbered, (unsigned long long)count.missing,
			(unsigned long long)count.doubled);
		return 0;
	}
	if (argc == 4 && !strcmp(argv[1], "--play"))
		return play(argv[3], argv[2]);
	if (argc != 4 || atof(argv[2]) <= 0.0 || atof(argv[3]) <= 0.0) {
		fprintf(stderr, "usage: can_load INTERFACE RATE SECONDS | --play LOG INTERFACE | --check LOG...\n");
		return 2;
	}
	return load(argv[1], atof(argv[2]), atof(argv[3]));
}
