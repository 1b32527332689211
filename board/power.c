#include "board/power.h"

#include "platform/base/clock.h"

#define OFF_AFTER_NS (2 * NS_PER_S)
#define OFF_FPS 2

void power_init(struct power *power, const struct power_config *config)
{
	*power = (struct power){ .config = *config, .off_ns = INT64_MIN };
	if (power->config.off_after_ns <= 0)
		power->config.off_after_ns = OFF_AFTER_NS;
	if (!power->config.off_fps)
		power->config.off_fps = OFF_FPS;
}

enum power_change power_advance(struct power *power, enum power_word line, enum power_word can, int64_t now_ns)
{
	if (line != POWER_SAYS_NOTHING)
		power->line = line;
	if (can != POWER_SAYS_NOTHING)
		power->can = can;
	enum power_word word = power->line != POWER_SAYS_NOTHING ? power->line : power->can;
	if (word != POWER_SAYS_OFF) {
		bool was_off = power->off;
		power->off = false;
		power->off_ns = INT64_MIN;
		return was_off ? POWER_GOES_ON : POWER_STAYS;
	}
	if (power->off_ns == INT64_MIN || now_ns < power->off_ns)
		power->off_ns = now_ns;
	if (power->off || now_ns - power->off_ns < power->config.off_after_ns)
		return POWER_STAYS;
	power->off = true;
	return POWER_GOES_OFF;
}

uint32_t power_fps(const struct power *power, uint32_t fps)
{
	return power->off && power->config.off_fps < fps ? power->config.off_fps : fps;
}
