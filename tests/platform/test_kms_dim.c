/* The panel's light by files as the kernel has them: dimmed, dark in standby, and never left dark. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "platform/display/kms.h"

static char folder[64];

static void file_path(char out[96], const char *name)
{
	snprintf(out, 96, "%s/%s", folder, name);
}

static void write_number(const char *name, unsigned value)
{
	char path[96];
	file_path(path, name);
	FILE *file = fopen(path, "w");
	assert_non_null(file);
	fprintf(file, "%u\n", value);
	fclose(file);
}

static unsigned brightness(void)
{
	char path[96], text[16] = "";
	file_path(path, "brightness");
	FILE *file = fopen(path, "r");
	assert_non_null(file);
	assert_non_null(fgets(text, sizeof(text), file));
	fclose(file);
	return (unsigned)strtoul(text, NULL, 10);
}

static int set_up(void **state)
{
	(void)state;
	snprintf(folder, sizeof(folder), "/tmp/blvd-test-backlight-XXXXXX");
	assert_non_null(mkdtemp(folder));
	write_number("max_brightness", 200);
	return 0;
}

static int tear_down(void **state)
{
	char path[96];
	(void)state;
	file_path(path, "brightness");
	unlink(path);
	file_path(path, "max_brightness");
	unlink(path);
	rmdir(folder);
	return 0;
}

static void the_light_follows_and_is_off_in_standby_only(void **state)
{
	static const struct {
		float level;
		unsigned value;
	} steps[] = { { 1.0f, 200 }, { 0.5f, 100 }, { 0.001f, 1 }, { 0.0f, 0 }, { 0.25f, 50 } };
	const struct display_config config = { .backlight = folder };
	struct kms kms = { .config = &config };
	(void)state;
	write_number("brightness", 120);
	kms_dim_open(&kms);
	assert_int_equal(brightness(), 120); /* nothing was drawn yet */
	for (size_t i = 0; i < sizeof(steps) / sizeof(steps[0]); i++) {
		kms_dim_set(&kms, steps[i].level);
		assert_int_equal(brightness(), steps[i].value);
	}
	kms_dim_close(&kms);
	assert_int_equal(brightness(), 50); /* a program that starts again at night does not dazzle */
}

static void a_program_that_ends_in_standby_leaves_the_light_as_it_found_it(void **state)
{
	const struct display_config config = { .backlight = folder };
	struct kms kms = { .config = &config };
	(void)state;
	write_number("brightness", 120);
	kms_dim_open(&kms);
	kms_dim_set(&kms, 0.5f);
	kms_dim_set(&kms, 0.0f);
	kms_dim_close(&kms);
	assert_int_equal(brightness(), 120);
}

static void a_light_that_a_killed_program_left_dark_comes_back(void **state)
{
	const struct display_config config = { .backlight = folder };
	struct kms kms = { .config = &config };
	(void)state;
	write_number("brightness", 0);
	kms_dim_open(&kms);
	kms_dim_set(&kms, 1.0f); /* full is what was thought to be there already */
	assert_int_equal(brightness(), 200);
	kms_dim_set(&kms, 0.0f);
	kms_dim_close(&kms);
	assert_int_equal(brightness(), 200);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test_setup_teardown(the_light_follows_and_is_off_in_standby_only, set_up, tear_down),
		cmocka_unit_test_setup_teardown(
			a_program_that_ends_in_standby_leaves_the_light_as_it_found_it, set_up, tear_down),
		cmocka_unit_test_setup_teardown(a_light_that_a_killed_program_left_dark_comes_back, set_up, tear_down),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
