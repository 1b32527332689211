#include "tools/measure/replay.h"

#include <errno.h>
#include <stdlib.h>

#include "board/inputs.h"
#include "board/profile.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"

#define FOV_DEG 45.0 /* the renderer's own */
#define ARENA_BYTES ((size_t)8 << 20)

struct replay {
	struct replay_config config;
	struct profile profile;
	struct options options;
	struct inputs inputs;
	struct camera camera;
	struct residency residency; /* everything is there: the eye does not depend on what has been loaded */
	struct obstacles obstacles;
	struct arena arena;
	uint32_t frames;
};

static struct residency whole_city(const struct pkg *pkg, struct arena *arena)
{
	struct residency out = { .pkg = pkg, .chunks = ARENA_ARRAY(arena, struct residency_chunk, pkg->chunk_count) };
	for (uint32_t i = 0; i < pkg->chunk_count && out.chunks; i++)
		out.chunks[i].state = RESIDENCY_PRESENT;
	return out;
}

int replay_open(struct replay **out, const struct pkg *pkg, const struct replay_config *config)
{
	size_t bytes = ARENA_BYTES + nav_bytes(&pkg->graph, &(struct nav_config){ 0 }) +
				   (size_t)pkg->chunk_count * sizeof(struct residency_chunk);
	uint8_t *memory = malloc(bytes);
	struct replay *replay = calloc(1, sizeof(*replay));
	if (!memory || !replay)
		abort();
	arena_init(&replay->arena, "replay", memory, bytes);
	replay->config = *config;
	replay->options.replay = config->log;
	replay->residency = whole_city(pkg, &replay->arena);
	replay->obstacles = (struct obstacles){ .pkg = pkg, .residency = &replay->residency };
	camera_init(&replay->camera, FOV_DEG * (BLVD_PI / 180.0));
	int status = profile_load(&replay->profile, config->profile, &replay->arena);
	if (!status)
		status = inputs_open(&replay->inputs, &replay->options, &replay->profile, pkg, &replay->arena);
	*out = replay;
	if (status < 0) {
		replay_close(replay);
		*out = NULL;
	}
	return status;
}

void replay_close(struct replay *replay)
{
	if (!replay)
		return;
	inputs_close(&replay->inputs);
	free(replay->arena.base);
	free(replay);
}

/* False at the end of the log. */
static bool advance(struct replay *replay, struct replay_frame *out)
{
	if (replay->frames && inputs_ended(&replay->inputs))
		return false;
	int64_t now_ns = (int64_t)replay->frames * NS_PER_S / replay->config.fps;
	inputs_advance(&replay->inputs, now_ns, &out->nav);
	camera_follow(&replay->camera, &out->nav, &replay->obstacles);
	out->number = replay->frames++;
	out->pose = replay->camera.pose;
	out->time = (struct renderer_time){
		.time_ns = now_ns,
		.wall_ns = inputs_wall_ns(&replay->inputs, now_ns),
		.ambient = out->nav.ambient,
	};
	return true;
}

bool replay_next(struct replay *replay, struct replay_frame *out)
{
	do {
		if (!advance(replay, out))
			return false;
	} while (!out->nav.located);
	return true;
}
