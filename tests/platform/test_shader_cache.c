/* Mesa's cache of shaders on a disk with room, without, and without a folder at all. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include "platform/display/shader_cache.h"

#define INDEX_BYTES 1310728 /* of Mesa 22.3 */

struct home {
	char folder[64], cache[96], index[128];
};

static int set_up(void **state)
{
	static struct home home;
	snprintf(home.folder, sizeof(home.folder), "/tmp/blvd-test-shaders-XXXXXX");
	assert_non_null(mkdtemp(home.folder));
	snprintf(home.cache, sizeof(home.cache), "%s/mesa_shader_cache", home.folder);
	snprintf(home.index, sizeof(home.index), "%s/index", home.cache);
	unsetenv("MESA_SHADER_CACHE_DISABLE");
	unsetenv("MESA_SHADER_CACHE_DIR");
	setenv("XDG_CACHE_HOME", home.folder, 1);
	*state = &home;
	return 0;
}

static int tear_down(void **state)
{
	const struct home *home = *state;
	unlink(home->index);
	rmdir(home->cache);
	rmdir(home->folder);
	return 0;
}

/* An index as Mesa makes it: all hole. */
static void make_index(const struct home *home, off_t bytes)
{
	assert_int_equal(mkdir(home->cache, 0700), 0);
	int fd = open(home->index, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
	assert_true(fd >= 0);
	assert_int_equal(ftruncate(fd, bytes), 0);
	close(fd);
}

static off_t blocks_of(const char *path)
{
	struct stat status;
	assert_int_equal(stat(path, &status), 0);
	assert_int_equal(status.st_size, INDEX_BYTES);
	return (off_t)status.st_blocks * 512;
}

static void the_index_gets_its_blocks_when_it_is_there(void **state)
{
	const struct home *home = *state;
	shader_cache_check();
	assert_null(getenv("MESA_SHADER_CACHE_DISABLE"));
	assert_int_not_equal(access(home->cache, F_OK), 0); /* Mesa makes it, not we */
	make_index(home, INDEX_BYTES);
	assert_true(blocks_of(home->index) < INDEX_BYTES);
	shader_cache_reserve();
	assert_true(blocks_of(home->index) >= INDEX_BYTES);
}

static void an_index_of_an_earlier_start_gets_them_before_it_is_mapped(void **state)
{
	const struct home *home = *state;
	make_index(home, INDEX_BYTES);
	shader_cache_check();
	assert_true(blocks_of(home->index) >= INDEX_BYTES);
	assert_null(getenv("MESA_SHADER_CACHE_DISABLE"));
}

static void an_empty_index_is_none(void **state)
{
	make_index(*state, 0);
	shader_cache_check();
	assert_null(getenv("MESA_SHADER_CACHE_DISABLE"));
}

static void a_disk_without_room_means_no_cache(void **state)
{
	(void)state;
	setenv("XDG_CACHE_HOME", "/proc", 1); /* has no free block, ever */
	shader_cache_check();
	assert_non_null(getenv("MESA_SHADER_CACHE_DISABLE"));
	shader_cache_reserve();
}

static void the_folder_is_chosen_as_mesa_does(void **state)
{
	const struct home *home = *state;
	setenv("XDG_CACHE_HOME", "/proc", 1);
	setenv("MESA_SHADER_CACHE_DIR", home->folder, 1);
	make_index(home, INDEX_BYTES);
	shader_cache_check();
	assert_null(getenv("MESA_SHADER_CACHE_DISABLE"));
	assert_true(blocks_of(home->index) >= INDEX_BYTES);
}

static void what_the_user_wants_stays(void **state)
{
	(void)state;
	setenv("XDG_CACHE_HOME", "/proc", 1);
	setenv("MESA_SHADER_CACHE_DISABLE", "false", 1);
	shader_cache_check();
	assert_string_equal(getenv("MESA_SHADER_CACHE_DISABLE"), "false");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_index_gets_its_blocks_when_it_is_there, set_up, tear_down),
		cmocka_unit_test_setup_teardown(an_index_of_an_earlier_start_gets_them_before_it_is_mapped, set_up, tear_down),
		cmocka_unit_test_setup_teardown(an_empty_index_is_none, set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_disk_without_room_means_no_cache, set_up, tear_down),
		cmocka_unit_test_setup_teardown(the_folder_is_chosen_as_mesa_does, set_up, tear_down),
		cmocka_unit_test_setup_teardown(what_the_user_wants_stays, set_up, tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
