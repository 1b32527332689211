/* The run: chunks of frames, entrants in turn. What a run is made of stands in settings.txt, so that no two mix. */
#include "tools/measure/trial.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include "assets/cells.h"
#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "tools/measure/trial_compare.h"

#define WARM_FRAMES 10u /* drawn before the first frame of a run that goes on */
#define SETTLING_NS (400 * NS_PER_MS)

/* When a representation last changed its cell. */
struct cell_watch {
	uint64_t entered;
	int64_t changed_ns;
};

struct trial {
	const struct trial_config *config;
	struct pkg pkg;
	ARRAY(struct replay_frame) drive;
	uint32_t frames; /* to be drawn */
	struct entrant entrants[TRIAL_ENTRANTS_MAX];
	struct cell_watch watches[TRIAL_ENTRANTS_MAX];
	bool open;
	uint32_t last_drawn; /* frame; drive.count: none */
	struct trial_result *out;
	float *work;
	int64_t began_ns, drawn_frames;
};

/* --- files --- */

static void chunk_path(const struct trial *trial, uint32_t chunk, uint32_t entrant, char path[PATH_MAX])
{
	snprintf(path, PATH_MAX, "%s/%s-%04u.csv", trial->config->folder, trial->config->names[entrant], chunk);
}

static int make_folder(const char *folder, const char *name, char path[PATH_MAX])
{
	snprintf(path, PATH_MAX, "%s%s%s", folder, name ? "/" : "", name ? name : "");
	int status = mkdir(path, 0777) < 0 && errno != EEXIST ? -errno : 0;
	if (status)
		log_error("%s: %s", path, strerror(-status));
	return status;
}

static int write_text(const char *path, const char *text)
{
	FILE *file = fopen(path, "w");
	int status = file ? 0 : -errno;
	if (file && (fputs(text, file) < 0 || fclose(file)))
		status = -EIO;
	if (status)
		log_error("%s: cannot write: %s", path, strerror(-status));
	return status;
}

static uint32_t crc_of(const struct file_map *map)
{
	return (uint32_t)crc32_z(0, map->bytes.data, map->bytes.size);
}

static int describe(const struct trial *trial, char *text, size_t size)
{
	const struct trial_config *c = trial->config;
	struct file_map log;
	int status = file_map_open(&log, c->log);
	if (status < 0) {
		log_error("%s: %s", c->log, strerror(-status));
		return status;
	}
	int at = snprintf(text, size,
		"tau %g\npackage %zu bytes, crc %08x\nlog %zu bytes, crc %08x\nsize %ux%u, %u samples\n%u frames a second, %u "
		"frames\n"
		"compared every %u, %u pictures\nbudget %llu MiB\noverlay %d\nrepresentations",
		c->tau_px, trial->pkg.map.bytes.size, crc_of(&trial->pkg.map), log.bytes.size, crc_of(&log), c->width,
		c->height, c->samples, c->fps, c->frames, c->every, c->pictures, (unsigned long long)(c->budget_bytes >> 20),
		c->overlay);
	for (uint32_t i = 0; i < c->count; i++)
		at += snprintf(text + at, size - (size_t)at, " %s", c->names[i]);
	snprintf(text + at, size - (size_t)at, "\n");
	file_map_close(&log);
	return 0;
}

/* The folder is new, or holds a run just like this. */
static int claim_folder(const struct trial *trial)
{
	char path[PATH_MAX], wanted[1024], found[1024] = { 0 };
	int status = describe(trial, wanted, sizeof(wanted));
	if (status < 0 || (status = make_folder(trial->config->folder, NULL, path)) < 0 ||
		(status = make_folder(trial->config->folder, "pictures", path)) < 0)
		return status;
	snprintf(path, sizeof(path), "%s/settings.txt", trial->config->folder);
	FILE *file = fopen(path, "r");
	if (!file)
		return write_text(path, wanted);
	size_t length = fread(found, 1, sizeof(found) - 1, file);
	fclose(file);
	if (length == strlen(wanted) && !strcmp(found, wanted))
		return 0;
	log_error("%s: holds a run with other settings; choose another folder, or remove it", path);
	return -EEXIST;
}

static bool chunk_done(const struct trial *trial, uint32_t chunk)
{
	char path[PATH_MAX];
	for (uint32_t i = 0; i < trial->config->count; i++) {
		chunk_path(trial, chunk, i, path);
		if (access(path, R_OK))
			return false;
	}
	return true;
}

static uint32_t chunk_count(const struct trial *trial)
{
	return (trial->frames + TRIAL_CHUNK_FRAMES - 1) / TRIAL_CHUNK_FRAMES;
}

/* --- the drive --- */

static int read_drive(struct trial *trial)
{
	const struct trial_config *c = trial->config;
	struct replay_config config = { .log = c->log, .profile = c->profile, .fps = c->fps };
	struct replay *replay;
	int status = replay_open(&replay, &trial->pkg, &config);
	if (status < 0)
		return status == -ENOMEM ? status : -EBADMSG;
	struct replay_frame frame;
	while ((!c->frames || trial->drive.count < c->frames) && replay_next(replay, &frame))
		ARRAY_PUSH(&trial->drive, frame);
	replay_close(replay);
	trial->frames = (uint32_t)trial->drive.count;
	trial->last_drawn = trial->frames;
	return 0;
}

static uint32_t stretch_of(const struct pkg *pkg, const struct nav_view *nav)
{
	if (!nav->located || nav->half == PKG_NONE)
		return PKG_NONE;
	int64_t along_mm = (int64_t)(nav->along_m * 1e3);
	if (nav->half & 1)
		along_mm = (int64_t)pkg->graph.edges[nav->half / 2].length_mm - along_mm;
	return cells_stretch_at(pkg, nav->half / 2, along_mm);
}

static bool same_cell(const struct pkg *pkg, const struct nav_view *a, const struct nav_view *b)
{
	uint32_t stretch = stretch_of(pkg, a);
	return stretch == stretch_of(pkg, b) && (stretch == PKG_NONE || (a->half & 1) == (b->half & 1));
}

/* By the street alone, for representations that know no cells. */
static enum trial_place place_on_street(const struct trial *trial, uint32_t number)
{
	const struct replay_frame *frames = trial->drive.items;
	const struct replay_frame *now = &frames[number];
	if (stretch_of(&trial->pkg, &now->nav) == PKG_NONE)
		return TRIAL_OFF;
	for (uint32_t i = number; i > 0 && now->nav.time_ns - frames[i].nav.time_ns <= SETTLING_NS; i--)
		if (!same_cell(&trial->pkg, &frames[i].nav, &frames[i - 1].nav))
			return i == number ? TRIAL_CHANGE : TRIAL_SETTLING;
	return TRIAL_INSIDE;
}

/* After the frame has been drawn. */
static enum trial_place place_of(
	struct trial *trial, uint32_t number, uint32_t which, const struct renderer_stats *stats)
{
	struct cell_watch *watch = &trial->watches[which];
	int64_t now_ns = trial->drive.items[number].nav.time_ns;
	bool changed = stats->far_entered != watch->entered;
	watch->entered = stats->far_entered;
	if (!stats->far_entered)
		return place_on_street(trial, number);
	if (changed)
		watch->changed_ns = now_ns;
	if (stats->far_fallback)
		return TRIAL_OFF;
	return changed ? TRIAL_CHANGE : now_ns - watch->changed_ns <= SETTLING_NS ? TRIAL_SETTLING : TRIAL_INSIDE;
}

/* --- entrants --- */

static struct entrant_config config_of(const struct trial *trial, uint32_t which, bool truth)
{
	const struct trial_config *c = trial->config;
	return (struct entrant_config){ .name = c->names[which],
		.tau_px = c->tau_px,
		.width = c->width,
		.height = c->height,
		.samples = c->samples,
		.budget_bytes = which ? c->budget_bytes : 0, /* the reference must have everything */
		.overlay = c->overlay,
		.truth = truth };
}

/* What a renderer costs by itself: time to the first picture, memory. Alone, and without what measuring needs. */
static int note_entrant(struct trial *trial, uint32_t which, uint32_t first)
{
	struct trial_entrant *out = &trial->out->entrants[which];
	struct entrant_config config = config_of(trial, which, false);
	struct entrant entrant;
	int status = entrant_open(&entrant, &trial->pkg, &config);
	if (status < 0)
		return status;
	status = entrant_draw(&entrant, &trial->drive.items[first]);
	struct renderer_stats stats;
	renderer_stats(entrant.renderer, &stats);
	out->start_ms = entrant.start_ms;
	out->first_frame_ms = entrant.start_ms + entrant.cpu_ms;
	out->cpu_bytes = entrant.arena.high_water;
	out->gpu_bytes = stats.gpu_bytes_high_water;
	snprintf(trial->out->gl_renderer, sizeof(trial->out->gl_renderer), "%s", stats.gl_renderer);
	entrant_close(&entrant);
	return status;
}

static int open_entrants(struct trial *trial, uint32_t first)
{
	int status = 0;
	for (uint32_t i = 0; i < trial->config->count && !status && !trial->out->entrants[i].gpu_bytes; i++)
		status = note_entrant(trial, i, first);
	trial->open = true;
	for (uint32_t i = 0; i < trial->config->count && !status; i++) {
		struct entrant_config config = config_of(trial, i, true);
		status = entrant_open(&trial->entrants[i], &trial->pkg, &config);
	}
	return status;
}

static int draw_all(struct trial *trial, uint32_t number)
{
	const struct trial_config *c = trial->config;
	const struct replay_frame *frame = &trial->drive.items[number];
	for (uint32_t i = 0; i < c->count; i++) {
		struct entrant *entrant = &trial->entrants[(number + i) % c->count];
		int status = entrant_draw(entrant, frame);
		if (status < 0)
			return status;
	}
	for (uint32_t i = 0; i < c->count; i++)
		entrant_see(&trial->entrants[i], trial->work);
	trial->drawn_frames++;
	return 0;
}

/* Brings the entrants to where they would be had they drawn everything before `first`. */
static int warm_up(struct trial *trial, uint32_t first)
{
	const struct trial_config *c = trial->config;
	bool fresh = !trial->open;
	bool follows = !fresh && trial->last_drawn + 1 == first;
	uint32_t from = first > WARM_FRAMES ? first - WARM_FRAMES : 0;
	int status = fresh ? open_entrants(trial, from) : 0;
	for (uint32_t i = 0; i < c->count && !follows; i++)
		popping_cut(&trial->entrants[i].popping);
	for (uint32_t number = from; (number < first || (fresh && number == from)) && !follows && !status; number++) {
		status = draw_all(trial, number);
		for (uint32_t i = 0; i < c->count && !status; i++) {
			struct popping_frame ignored;
			struct renderer_stats stats;
			renderer_stats(trial->entrants[i].renderer, &stats);
			place_of(trial, number, i, &stats);
			popping_add(
				&trial->entrants[i].popping, trial->entrants[0].lightness, trial->entrants[i].lightness, &ignored);
		}
	}
	if (first == 0) /* drawn twice: nothing came before it */
		for (uint32_t i = 0; i < c->count; i++)
			popping_cut(&trial->entrants[i].popping);
	return status;
}

/* --- rows --- */

static struct trial_row row_of(struct trial *trial, uint32_t number, uint32_t which)
{
	struct entrant *entrant = &trial->entrants[which];
	const struct nav_view *nav = &trial->drive.items[number].nav;
	struct renderer_stats stats;
	renderer_stats(entrant->renderer, &stats);
	struct trial_row row = {
		.frame = number,
		.half = nav->located ? nav->half : PKG_NONE,
		.stretch = stretch_of(&trial->pkg, nav),
		.place = place_of(trial, number, which, &stats),
		.triangles = stats.triangles,
		.far_triangles = stats.far_triangles,
		.draws = stats.draws,
		.gpu_bytes = stats.gpu_bytes,
		.fallback = stats.far_fallback,
		.late = stats.far_late,
		.error_px = stats.far_error_px,
		.cpu_ms = entrant->cpu_ms,
		.wall_ms = entrant->wall_ms,
	};
	row.popping_known = popping_add(&entrant->popping, trial->entrants[0].lightness, entrant->lightness, &row.popping);
	return row;
}

/* Whether this compared frame is one of those that are kept as pictures. */
static bool is_pictured(const struct trial *trial, uint32_t number)
{
	uint64_t compared = (trial->frames + trial->config->every - 1) / trial->config->every;
	uint64_t index = number / trial->config->every, pictures = trial->config->pictures;
	return index * pictures / compared != (index + 1) * pictures / compared;
}

static int compare_entrant(struct trial *trial, uint32_t number, uint32_t which,
	const struct trial_reference *reference, struct trial_row *row)
{
	struct entrant *entrant = &trial->entrants[which], *full = &trial->entrants[0];
	bool pictured = is_pictured(trial, number);
	char folder[PATH_MAX], map[PATH_MAX];
	snprintf(folder, sizeof(folder), "%s/pictures", trial->config->folder);
	if (snprintf(map, sizeof(map), "%s/%s-%06u-displaced.png", folder, entrant->config.name, number) >=
		(int)sizeof(map))
		return -ENAMETOOLONG;
	int status = pictured ? trial_write_pictures(folder, number, full, entrant) : 0;
	if (status || which == 0)
		return status;
	return trial_compare(
		&trial->pkg, &trial->drive.items[number], full, reference, entrant, row, pictured ? map : NULL);
}

static int compare_all(struct trial *trial, uint32_t number, struct trial_row *rows)
{
	struct trial_reference reference;
	int status = trial_reference(&trial->drive.items[number], &trial->entrants[0], &reference);
	for (uint32_t i = 0; i < trial->config->count && !status; i++)
		status = compare_entrant(trial, number, i, &reference, &rows[i]);
	trial_reference_finish(&reference);
	return status;
}

static void show_progress(const struct trial *trial, uint32_t number)
{
	if (!trial->config->show_progress || !trial->drawn_frames)
		return;
	double a_frame = (double)(clock_now_ns() - trial->began_ns) * 1e-9 / (double)trial->drawn_frames;
	double left_s = a_frame * (trial->frames - number - 1);
	fprintf(stderr, "\r\033[K%s: frame %u of %u, %u representations, %.2f s a frame, %.0f min still",
		trial->config->title, number + 1, trial->frames, trial->config->count, a_frame, left_s / 60.0);
}

static int write_chunk(const struct trial *trial, uint32_t chunk, const struct trial_rows *rows)
{
	char path[PATH_MAX];
	int status = 0;
	for (uint32_t i = 0; i < trial->config->count && !status; i++) {
		chunk_path(trial, chunk, i, path);
		status = trial_rows_write(&rows[i], path);
	}
	return status;
}

static int run_chunk(struct trial *trial, uint32_t chunk)
{
	const struct trial_config *c = trial->config;
	struct trial_rows rows[TRIAL_ENTRANTS_MAX] = { 0 };
	uint32_t first = chunk * TRIAL_CHUNK_FRAMES, end = first + TRIAL_CHUNK_FRAMES;
	end = end < trial->frames ? end : trial->frames;
	int status = warm_up(trial, first);
	for (uint32_t number = first; number < end && !status; number++) {
		struct trial_row row[TRIAL_ENTRANTS_MAX];
		status = draw_all(trial, number);
		for (uint32_t i = 0; i < c->count && !status; i++)
			row[i] = row_of(trial, number, i);
		if (!status && number % c->every == 0)
			status = compare_all(trial, number, row);
		for (uint32_t i = 0; i < c->count && !status; i++)
			ARRAY_PUSH(&rows[i].rows, row[i]);
		trial->last_drawn = number;
		show_progress(trial, number);
	}
	if (!status)
		status = write_chunk(trial, chunk, rows);
	for (uint32_t i = 0; i < c->count; i++)
		ARRAY_FINISH(&rows[i].rows);
	return status;
}

/* --- the figures of entrants, kept beside the chunks --- */

static void entrants_path(const struct trial *trial, char path[PATH_MAX])
{
	snprintf(path, PATH_MAX, "%s/entrants.csv", trial->config->folder);
}

static int write_entrants(const struct trial *trial)
{
	char path[PATH_MAX], text[2048];
	int at =
		snprintf(text, sizeof(text), "name,start_ms,first_frame_ms,cpu_bytes,gpu_bytes,%s\n", trial->out->gl_renderer);
	for (uint32_t i = 0; i < trial->config->count; i++) {
		const struct trial_entrant *e = &trial->out->entrants[i];
		at += snprintf(text + at, sizeof(text) - (size_t)at, "%s,%.3f,%.3f,%llu,%llu\n", e->name, e->start_ms,
			e->first_frame_ms, (unsigned long long)e->cpu_bytes, (unsigned long long)e->gpu_bytes);
	}
	entrants_path(trial, path);
	return write_text(path, text);
}

/* Missing figures stay 0. */
static void read_entrants(struct trial *trial)
{
	char path[PATH_MAX], line[256];
	entrants_path(trial, path);
	FILE *file = fopen(path, "r");
	if (!file)
		return;
	if (fgets(line, sizeof(line), file))
		sscanf(line, "name,start_ms,first_frame_ms,cpu_bytes,gpu_bytes,%95[^\n]", trial->out->gl_renderer);
	for (uint32_t i = 0; i < trial->config->count && fgets(line, sizeof(line), file); i++) {
		struct trial_entrant *e = &trial->out->entrants[i];
		unsigned long long cpu = 0, gpu = 0;
		if (sscanf(line, "%*[^,],%lf,%lf,%llu,%llu", &e->start_ms, &e->first_frame_ms, &cpu, &gpu) == 4) {
			e->cpu_bytes = cpu;
			e->gpu_bytes = gpu;
		}
	}
	fclose(file);
}

static int read_chunks(struct trial *trial)
{
	char path[PATH_MAX];
	int status = 0;
	for (uint32_t chunk = 0; chunk < chunk_count(trial); chunk++) {
		for (uint32_t i = 0; i < trial->config->count && !status; i++) {
			chunk_path(trial, chunk, i, path);
			status = trial_rows_read(&trial->out->rows[i], path);
		}
	}
	return status;
}

static int run_missing(struct trial *trial)
{
	int status = 0;
	size_t pixels = (size_t)trial->config->width * trial->config->height;
	trial->work = array_grow(NULL, &(size_t){ 0 }, pixels, sizeof(float));
	trial->began_ns = clock_now_ns();
	read_entrants(trial);
	for (uint32_t chunk = 0; chunk < chunk_count(trial) && !status; chunk++) {
		if (chunk_done(trial, chunk))
			continue;
		status = run_chunk(trial, chunk);
		if (!status)
			status = write_entrants(trial);
	}
	if (trial->config->show_progress)
		fprintf(stderr, "\r\033[K");
	for (uint32_t i = 0; i < trial->config->count; i++)
		entrant_close(&trial->entrants[i]);
	array_free(trial->work);
	return status ? status : read_chunks(trial);
}

int trial_run(const struct trial_config *config, struct trial_result *out)
{
	struct trial *trial = calloc(1, sizeof(*trial));
	if (!trial)
		abort();
	*out = (struct trial_result){ .count = config->count };
	for (uint32_t i = 0; i < config->count; i++)
		snprintf(out->entrants[i].name, sizeof(out->entrants[i].name), "%s", config->names[i]);
	trial->config = config;
	trial->out = out;
	struct pkg_fault fault = { 0 };
	int status = pkg_open(&trial->pkg, config->package, &fault);
	if (status < 0) {
		log_error("%s: %s", config->package, status == -EBADMSG ? fault.text : strerror(-status));
		status = -EBADMSG;
	} else if ((status = claim_folder(trial)) == 0 && (status = read_drive(trial)) == 0) {
		status = run_missing(trial);
	}
	if (trial->pkg.meta)
		pkg_close(&trial->pkg);
	ARRAY_FINISH(&trial->drive);
	free(trial);
	return status;
}

void trial_result_finish(struct trial_result *result)
{
	for (uint32_t i = 0; i < result->count; i++)
		ARRAY_FINISH(&result->rows[i].rows);
	*result = (struct trial_result){ 0 };
}
