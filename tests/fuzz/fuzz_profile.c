/* Any text as a profile. Its definitions are always the virtual car's, so that no file is opened. */
#include "board/car.h"
#include "platform/base/log.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static _Alignas(64) uint8_t memory[1 << 20];
	static const char *const dbc[] = { PROFILE_DBC_BUILTIN };
	static struct car car;
	struct arena arena;
	struct profile profile;
	struct profile_error error;
	log_init("fuzz", LOG_NONE); /* every fault is a line */
	arena_init(&arena, "fuzz", memory, sizeof(memory));
	if (profile_parse(&profile, "x/y.ini", (const char *)data, size, &arena, &error) == 0)
		car_init(&car, &profile, dbc, 1, NULL, 0, &arena);
	return 0;
}
