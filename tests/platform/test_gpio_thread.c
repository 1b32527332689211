/*
 * The thread that reads the kernel's lines, on a made-up kernel: the shim's functions are defined here, each line a
 * pipe that, like the kernel's queue of version 1, keeps 16 events and drops what comes after. So what no simulated
 * chip can do is tried: a thousand and ten thousand edges a second, overruns, edges that come late, a chip that goes.
 */
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/gpio/gpiod_shim.h"
#include "platform/gpio/quadrature.h"

#ifdef BLVD_HAVE_GPIOD
enum { REVERSE, A, B, LINES };

static struct kernel_line {
	int ends[2]; /* of the pipe; the thread has the first one */
	atomic_int level;
	atomic_int status; /* of a request, 0 or -errno; of a level that is read too */
	atomic_bool held;
	uint32_t number;
	bool numbered; /* as version 2 */
	uint32_t queue;
} kernel[LINES];

int gpiod_shim_init(struct gpiod_shim *shim, const char *consumer)
{
	*shim = (struct gpiod_shim){ .consumer = consumer };
	return 0;
}

void gpiod_shim_finish(struct gpiod_shim *shim)
{
	(void)shim;
}

int gpiod_shim_label(const char *path, char *label, size_t size)
{
	(void)path;
	(void)label;
	(void)size;
	return -ENODEV;
}

int gpiod_shim_request(
	struct gpiod_shim *shim, const char *path, const struct gpio_line_config *config, struct gpiod_shim_line *line)
{
	(void)shim;
	(void)path;
	struct kernel_line *at = &kernel[config->offset];
	if (at->status)
		return at->status;
	line->request = at;
	at->held = true;
	return 0;
}

void gpiod_shim_release(struct gpiod_shim_line *line)
{
	if (line->request)
		((struct kernel_line *)line->request)->held = false;
	line->request = NULL;
}

int gpiod_shim_fd(const struct gpiod_shim_line *line)
{
	return ((struct kernel_line *)line->request)->ends[0];
}

int gpiod_shim_level(const struct gpiod_shim_line *line)
{
	struct kernel_line *at = line->request;
	return at->status ? at->status : at->level;
}

int gpiod_shim_read(struct gpiod_shim *shim, const struct gpiod_shim_line *line, struct gpiod_shim_event *events)
{
	(void)shim;
	ssize_t size = read(gpiod_shim_fd(line), events, GPIOD_SHIM_BATCH * sizeof(*events));
	if (size < 0)
		return errno == EAGAIN ? 0 : -errno;
	return (int)(size / (ssize_t)sizeof(*events));
}

const char *gpiod_shim_name(void)
{
	return "made up";
}

static void edge_at(int line, bool level, int64_t time_ns)
{
	struct kernel_line *at = &kernel[line];
	struct gpiod_shim_event event = { .time_ns = time_ns, .level = level };
	int bytes = 0;
	at->level = level;
	at->number++;
	event.number = at->numbered ? at->number : 0;
	ioctl(at->ends[0], FIONREAD, &bytes);
	if ((size_t)bytes < at->queue * sizeof(event))
		assert_int_equal(write(at->ends[1], &event, sizeof(event)), sizeof(event));
}

static void edge(int line, bool level)
{
	edge_at(line, level, clock_now_ns());
}

static _Alignas(64) uint8_t memory[1 << 20];
static struct arena arena;
static struct gpio *gpio;
static struct gpio_event events[8192];

static int start(void **state)
{
	(void)state;
	static const char *const names[LINES] = { "reverse", "rotary_a", "rotary_b" };
	struct gpio_line_config lines[LINES];
	for (unsigned i = 0; i < LINES; i++) {
		kernel[i] = (struct kernel_line){ .queue = 16 };
		assert_int_equal(pipe2(kernel[i].ends, O_NONBLOCK), 0);
		lines[i] = (struct gpio_line_config){ .chip = "/made/up", .offset = i };
	}
	struct gpio_config config = { .lines = lines, .line_count = LINES, .names = names };
	arena_init(&arena, "test", memory, sizeof(memory));
	return gpio_open(&gpio, &gpio_libgpiod_ops, &config, &arena);
}

static int stop(void **state)
{
	(void)state;
	gpio_close(gpio);
	for (int i = 0; i < LINES; i++) {
		assert_false(kernel[i].held);
		close(kernel[i].ends[0]);
		close(kernel[i].ends[1]);
	}
	return 0;
}

static void pause_ms(int ms)
{
	clock_sleep_until(clock_now_ns() + ms * NS_PER_MS);
}

static int read_all(void)
{
	return gpio_read(gpio, clock_now_ns(), events, 8192);
}

static int wait_for_state(unsigned line, enum gpio_state state)
{
	for (int ms = 0; ms < 2500; ms++) {
		read_all();
		if (gpio->lines[line].state == state)
			return ms;
		pause_ms(1);
	}
	return -1;
}

/* Detents of the knob in what was read; checks the order of times. */
static int detents_in(int count, struct quadrature *knob)
{
	int detents = 0;
	int64_t last = INT64_MIN;
	for (int i = 0; i < count; i++) {
		assert_true(events[i].time_ns >= last);
		last = events[i].time_ns;
		if (events[i].line == REVERSE || events[i].kind == GPIO_STATE)
			continue;
		if (events[i].kind == GPIO_LEVEL)
			quadrature_level(knob, events[i].line == B, events[i].level, events[i].time_ns);
		else
			detents += quadrature_edge(knob, events[i].line == B, events[i].level, events[i].time_ns);
	}
	return detents;
}

static void turn_knob(int edges, int64_t period_ns)
{
	int64_t began = clock_now_ns();
	for (int i = 0; i < edges; i++) {
		clock_sleep_until(began + i * period_ns);
		edge(i % 2 ? B : A, !kernel[i % 2 ? B : A].level);
	}
}

static void a_thousand_edges_a_second_all_count_while_nobody_reads(void **state)
{
	(void)state;
	struct quadrature knob;
	quadrature_init(&knob, 4);
	kernel[A].queue = kernel[B].queue = 256; /* as version 2 has it; 16 are enough where nothing else runs */
	kernel[A].numbered = kernel[B].numbered = true;
	turn_knob(400, NS_PER_MS);
	pause_ms(20);
	assert_int_equal(detents_in(read_all(), &knob), 100);
	assert_int_equal(knob.lost, 0);
	assert_int_equal(gpio->stats.edges, 400);
}

static void edges_of_two_lines_come_in_the_order_of_their_times(void **state)
{
	(void)state;
	struct quadrature knob;
	quadrature_init(&knob, 4);
	detents_in(read_all(), &knob);
	/* the second contact's edge is there first, though it was later: threads of the kernel race */
	for (int i = 0; i < 40; i++) {
		int64_t now = clock_now_ns() + 5 * NS_PER_MS;
		bool level = i % 2 == 0;
		edge_at(B, level, now + 1000);
		edge_at(A, level, now);
		pause_ms(1);
	}
	pause_ms(20);
	assert_int_equal(detents_in(read_all(), &knob), 20);
}

static void an_overrun_of_the_kernels_queue_ends_with_the_right_level(void **state)
{
	(void)state;
	for (int numbered = 0; numbered < 2; numbered++) {
		kernel[REVERSE].numbered = numbered;
		kernel[REVERSE].queue = 16;
		/* the thread cannot take them as fast as this */
		for (int i = 0; i < 401; i++)
			edge(REVERSE, i % 2 == numbered);
		kernel[REVERSE].queue = 0; /* the last one is lost for certain */
		edge(REVERSE, numbered == 0);
		bool last = kernel[REVERSE].level;
		int count = 0;
		for (int ms = 0; ms < 1500 && (count == 0 || gpio->lines[REVERSE].level != last); ms++) {
			count += read_all();
			pause_ms(1);
		}
		assert_int_equal(gpio->lines[REVERSE].level, last);
	}
	assert_true(gpio->stats.resyncs > LINES);
}

static void a_full_ring_drops_and_then_tells_the_level(void **state)
{
	(void)state;
	kernel[REVERSE].queue = 1000;
	for (int i = 0; i < 12001; i++) {
		edge(REVERSE, i % 2 == 0);
		if (i % 200 == 0)
			pause_ms(2);
	}
	pause_ms(100);
	assert_in_range(read_all(), 4096, 8191); /* a slow reader gets what comes while it reads, too */
	for (int ms = 0; ms < 1500 && !gpio->lines[REVERSE].level; ms++) {
		pause_ms(1);
		read_all();
	}
	assert_true(gpio->lines[REVERSE].level);
}

static void a_line_that_goes_is_told_and_comes_back_with_its_level(void **state)
{
	(void)state;
	read_all();
	assert_int_equal(gpio->lines[REVERSE].state, GPIO_GOOD);
	kernel[REVERSE].status = -ENODEV;
	assert_true(wait_for_state(REVERSE, GPIO_GONE) >= 0);
	assert_false(kernel[REVERSE].held);
	assert_int_equal(gpio->lines[A].state, GPIO_GOOD);
	kernel[REVERSE].status = -EBUSY;
	assert_true(wait_for_state(REVERSE, GPIO_BUSY) >= 0);
	kernel[REVERSE].level = 1;
	kernel[REVERSE].status = 0;
	assert_true(wait_for_state(REVERSE, GPIO_GOOD) >= 0);
	pause_ms(5);
	read_all();
	assert_true(gpio->lines[REVERSE].level);
	assert_int_equal(gpio->stats.losses, 1);
}

static void stamps_of_the_wall_clock_are_made_monotonic(void **state)
{
	(void)state;
	read_all();
	int64_t before = clock_now_ns();
	edge_at(REVERSE, true, clock_wall_ns());
	pause_ms(10);
	assert_int_equal(read_all(), 1);
	assert_true(events[0].time_ns >= before - NS_PER_MS && events[0].time_ns <= clock_now_ns());
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(a_thousand_edges_a_second_all_count_while_nobody_reads, start, stop),
		cmocka_unit_test_setup_teardown(edges_of_two_lines_come_in_the_order_of_their_times, start, stop),
		cmocka_unit_test_setup_teardown(an_overrun_of_the_kernels_queue_ends_with_the_right_level, start, stop),
		cmocka_unit_test_setup_teardown(a_full_ring_drops_and_then_tells_the_level, start, stop),
		cmocka_unit_test_setup_teardown(a_line_that_goes_is_told_and_comes_back_with_its_level, start, stop),
		cmocka_unit_test_setup_teardown(stamps_of_the_wall_clock_are_made_monotonic, start, stop),
	};
	log_init("test", LOG_ERROR);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
#else
int main(void)
{
	puts("built without libgpiod");
	return 0;
}
#endif
