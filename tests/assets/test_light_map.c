/* What a package's light map may say of itself. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "assets/pkg_check.h"

#define HEAD sizeof(struct pkg_light_map)

static const struct {
	const char *name;
	struct pkg_light_map map;
	uint64_t bytes; /* of the texels */
	int status;
} cases[] = {
	{ "plain", { .texel_mm = 2000, .width = 5, .height = 3 }, 30, 0 },
	{ "blocks, with what lies over the edge", { .texel_mm = 1, .width = 5, .height = 3, .format = 1 }, 32, 0 },
	{ "plain, cut", { .texel_mm = 2000, .width = 5, .height = 3 }, 29, -EINVAL },
	{ "blocks as if plain", { .texel_mm = 2000, .width = 5, .height = 3, .format = 1 }, 30, -EINVAL },
	{ "more than there is", { .texel_mm = 2000, .width = 5, .height = 3, .format = 1 }, 48, -EINVAL },
	{ "unknown format", { .texel_mm = 2000, .width = 5, .height = 3, .format = 2 }, 32, -EINVAL },
	{ "no texels", { .texel_mm = 2000, .width = 0, .height = 3 }, 0, -EINVAL },
	{ "no size", { .texel_mm = 0, .width = 5, .height = 3 }, 30, -EINVAL },
	{ "too wide", { .texel_mm = 1, .width = PKG_LIGHT_SIDE_MAX + 1, .height = 1 }, 2 * 16385, -EINVAL },
	{ "sides whose product overflows", { .texel_mm = 1, .width = 1u << 31, .height = 1u << 31, .format = 1 }, 0,
		-EINVAL },
};

static void a_light_map_is_what_its_bytes_can_hold(void **state)
{
	(void)state;
	for (size_t k = 0; k < sizeof(cases) / sizeof(cases[0]); k++) {
		uint8_t *section = calloc(1, HEAD + cases[k].bytes);
		struct pkg pkg = { .map.bytes = { .data = section, .size = HEAD + cases[k].bytes } };
		struct pkg_fault fault = { 0 };
		memcpy(section, &cases[k].map, HEAD);
		int status = pkg_check_light_map(&pkg, section, HEAD + cases[k].bytes, &fault);
		if (!status != !cases[k].status || !pkg.light_map != !!cases[k].status)
			fail_msg("%s: %d, %s", cases[k].name, status, fault.text);
		free(section);
	}
}

static void a_header_that_is_cut_is_refused(void **state)
{
	(void)state;
	struct pkg_light_map map = { .texel_mm = 1, .width = 1, .height = 1 };
	struct pkg pkg = { .map.bytes = { .data = (const uint8_t *)&map, .size = HEAD } };
	struct pkg_fault fault;
	assert_true(pkg_check_light_map(&pkg, &map, HEAD - 1, &fault) < 0);
	assert_int_equal(pkg_check_light_map(&pkg, NULL, 0, &fault), 0);
	assert_null(pkg.light_map);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_light_map_is_what_its_bytes_can_hold),
		cmocka_unit_test(a_header_that_is_cut_is_refused),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
