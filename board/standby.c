#include "board/standby.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"

/* systemd gives several folders separated by colons; ours is the first. */
static const char *state_folder(const struct options *options, char *buffer, size_t size)
{
	const char *folder = options->state;
	if (!folder && !options->replay)
		folder = getenv("STATE_DIRECTORY");
	if (!folder || !*folder)
		return NULL;
	if (!options->state && strchr(folder, ':')) {
		snprintf(buffer, size, "%.*s", (int)strcspn(folder, ":"), folder);
		return buffer;
	}
	return folder;
}

void standby_open(struct standby *standby, const struct options *options, const struct profile *profile)
{
	char buffer[RECORD_PATH_MAX];
	*standby = (struct standby){ .order = STANDBY_RUN };
	struct power_config power = profile->power;
	power.off_fps = profile->fps_ignition_off;
	power_init(&standby->power, &power);
	const char *folder = state_folder(options, buffer, sizeof(buffer));
	standby->keeps = folder && position_state_open(&standby->position, &file_ops_system, NULL, folder) == 0;
}

void standby_begin(struct standby *standby, const struct options *options, struct inputs *inputs)
{
	if (standby->begun || !inputs->nav.pkg)
		return;
	standby->begun = true;
	if (standby->keeps)
		position_state_begin(&standby->position, &inputs->nav, inputs->nav.pkg, !options->has_start);
}

static enum power_word can_word(const struct vehicle_state *state)
{
	return state->ignition == VEHICLE_IGNITION_UNKNOWN ? POWER_SAYS_NOTHING
		   : state->ignition == VEHICLE_IGNITION_OFF   ? POWER_SAYS_OFF
													   : POWER_SAYS_ON;
}

static enum power_word line_word(const struct control_switch *line)
{
	return !line->known ? POWER_SAYS_NOTHING : line->on ? POWER_SAYS_ON : POWER_SAYS_OFF;
}

enum standby_order standby_advance(
	struct standby *standby, struct inputs *inputs, const struct control_switch *line, int64_t now_ns)
{
	switch (power_advance(&standby->power, line_word(line), can_word(&inputs->state), now_ns)) {
	case POWER_GOES_OFF:
		log_info("ignition off: the display goes dark%s", standby->power.config.ends ? ", the program ends" : "");
		position_state_hurry(&standby->position);
		standby->order = standby->power.config.ends ? STANDBY_END : STANDBY_DARK;
		break;
	case POWER_GOES_ON:
		log_info("ignition on");
		standby->order = STANDBY_RUN;
		break;
	case POWER_STAYS:
		break;
	}
	if (standby->keeps && standby->begun)
		position_state_follow(&standby->position, &inputs->nav, &inputs->state, now_ns, inputs_wall_ns(inputs, now_ns));
	return standby->order;
}

void standby_close(struct standby *standby, struct inputs *inputs)
{
	if (standby->keeps)
		position_state_close(&standby->position, &inputs->nav, &inputs->state, inputs_wall_ns(inputs, inputs->now_ns));
	standby->keeps = false;
}
