/* The simulated camera's faults on command, by its pipe. */
#include <fcntl.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/camera/camera.h"

#define FRAME_NS (NS_PER_S / 30)

struct watch {
	struct camera_device camera;
	uint8_t *memory;
	int64_t now_ns;
	unsigned frames, changes;
	uint32_t digest;
};

static void look(struct watch *watch, double seconds)
{
	watch->frames = watch->changes = 0;
	for (int64_t until = watch->now_ns + (int64_t)(seconds * 1e9); watch->now_ns < until;) {
		struct camera_frame frame;
		watch->now_ns += FRAME_NS;
		if (!camera_latest(&watch->camera, watch->now_ns, &frame))
			continue;
		watch->frames++;
		watch->changes += frame.digest != watch->digest;
		watch->digest = frame.digest;
	}
}

static void say(const char *path, const char *text)
{
	int fd = open(path, O_WRONLY | O_NONBLOCK);
	assert_true(fd >= 0);
	assert_int_equal(write(fd, text, strlen(text)), strlen(text));
	close(fd);
}

static void faults_come_by_the_pipe_and_pass(void **state)
{
	(void)state;
	char path[64], script[128];
	snprintf(path, sizeof(path), "/tmp/blvd_camera_%d", (int)getpid());
	snprintf(script, sizeof(script), "320x180,control=%s", path);
	assert_int_equal(mkfifo(path, 0600), 0);
	struct watch watch = { .memory = malloc(4 << 20) };
	struct arena arena;
	arena_init(&arena, "camera", watch.memory, 4 << 20);
	assert_int_equal(camera_open(&watch.camera, &camera_sim, &(struct camera_config){ .source = script }, &arena), 0);
	look(&watch, 1.0);
	assert_true(watch.frames > 20 && watch.changes == watch.frames);
	say(path, "frozen 2\n");
	look(&watch, 1.5);
	assert_true(watch.frames > 40 && watch.changes <= 1);
	look(&watch, 1.5);
	assert_true(watch.changes > 25);
	say(path, "stal");
	say(path, "led 1\nnonsense 3\nfrozen\nfrozen -1\nfrozen 1 2\n\n");
	look(&watch, 0.9);
	assert_int_equal(watch.frames, 0);
	look(&watch, 1.0);
	assert_true(watch.frames > 20);
	for (int i = 0; i < 100; i++)
		say(path, "late 0.5\n");
	look(&watch, 2.0);
	say(path, "torn 0.5\n");
	look(&watch, 0.4);
	assert_int_equal(watch.frames, 0);
	camera_close(&watch.camera);
	unlink(path);
	assert_int_not_equal(
		camera_open(&watch.camera, &camera_sim, &(struct camera_config){ .source = script }, &arena), 0);
	free(watch.memory);
}

int main(void)
{
	const struct CMUnitTest tests[] = { cmocka_unit_test(faults_come_by_the_pipe_and_pass) };
	return cmocka_run_group_tests(tests, NULL, NULL);
}
