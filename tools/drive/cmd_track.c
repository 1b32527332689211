/* blvd track: how well a log is followed, as JSON. */
#include <argp.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/commands.h"
#include "tools/drive/track.h"

#define DBC_MAX PROFILE_DBC_MAX

enum { KEY_CITY = 256, KEY_TRUTH, KEY_PROFILE, KEY_DBC, KEY_GNSS, KEY_FREE, KEY_STEP, KEY_TRACE };

struct arguments {
	const char *log, *city, *truth, *profile, *trace;
	const char *dbc[DBC_MAX];
	unsigned dbc_count;
	bool gnss, free;
	double step_s;
};

static const struct argp_option option_list[] = {
	{ "city", KEY_CITY, "CITY.blvd", 0, "match to its streets; default: dead reckoning alone", 0 },
	{ "truth", KEY_TRUTH, "FILE.csv", 0, "what blvd drive --truth wrote with the log", 0 },
	{ "profile", KEY_PROFILE, "FILE", 0, "names of the car's signals; default: the virtual car", 0 },
	{ "dbc", KEY_DBC, "FILE", 0, "signal definitions, instead of the profile's", 0 },
	{ "gnss", KEY_GNSS, NULL, 0, "use satellite fixes beyond the first", 0 },
	{ "free", KEY_FREE, NULL, 0, "without the route that the log asks for", 0 },
	{ "step", KEY_STEP, "SECONDS", 0, "between updates; default 0.02", 0 },
	{ "trace", KEY_TRACE, "FILE.csv", 0, "where the navigator said the car was", 0 },
	{ 0 },
};

static error_t parse_option(int key, char *arg, struct argp_state *state)
{
	struct arguments *arguments = state->input;
	char *end;
	switch (key) {
	case KEY_CITY:
		arguments->city = arg;
		break;
	case KEY_TRUTH:
		arguments->truth = arg;
		break;
	case KEY_PROFILE:
		arguments->profile = arg;
		break;
	case KEY_DBC:
		if (arguments->dbc_count == DBC_MAX)
			argp_error(state, "at most %d times --dbc", DBC_MAX);
		arguments->dbc[arguments->dbc_count++] = arg;
		break;
	case KEY_GNSS:
		arguments->gnss = true;
		break;
	case KEY_FREE:
		arguments->free = true;
		break;
	case KEY_STEP:
		arguments->step_s = strtod(arg, &end);
		if (end == arg || *end || !(arguments->step_s >= 0.001 && arguments->step_s <= 10.0))
			argp_error(state, "'%s' is no step from 0.001 to 10 s", arg);
		break;
	case KEY_TRACE:
		arguments->trace = arg;
		break;
	case ARGP_KEY_ARG:
		if (arguments->log)
			argp_error(state, "one log, please");
		arguments->log = arg;
		break;
	case ARGP_KEY_END:
		if (!arguments->log)
			argp_error(state, "a log is needed");
		if (arguments->truth && !arguments->city)
			argp_error(state, "--truth needs --city");
		break;
	default:
		return ARGP_ERR_UNKNOWN;
	}
	return 0;
}

static double share(uint64_t part, uint64_t whole)
{
	return whole ? (double)part / (double)whole : 0.0;
}

static void print_result(const struct track_result *r, bool city, bool truth)
{
	printf("{\"seconds\":%.2f, \"km\":%.3f, \"frames\":%llu, \"frames_bad\":%llu", r->seconds, r->km,
		(unsigned long long)r->frames, (unsigned long long)r->frames_bad);
	if (truth)
		printf(",\n \"samples\":%llu, \"right\":%.5f, \"exact\":%.5f, \"on_street\":%.5f, \"wrong_run_m\":%.1f,\n"
			   " \"position_m\":{\"p50\":%.2f, \"p95\":%.2f, \"max\":%.2f}, \"along_p95_m\":%.2f,"
			   " \"heading_p95_deg\":%.2f",
			(unsigned long long)r->samples, share(r->right, r->samples), share(r->exact, r->samples),
			share(r->on_street, r->samples), r->wrong_run_m, r->pos_p50_m, r->pos_p95_m, r->pos_max_m, r->along_p95_m,
			r->heading_p95_deg);
	if (city)
		printf(",\n \"routed\":%s, \"reroutes\":%u, \"off_route_s\":%.2f, \"arrived\":%s", r->routed ? "true" : "false",
			r->reroutes, r->off_route_s, r->arrived ? "true" : "false");
	if (r->stretches)
		printf(",\n \"reckoning_m_per_km\":{\"stretches\":%u, \"p50\":%.2f, \"p95\":%.2f, \"max\":%.2f,"
			   " \"along_p50\":%.2f, \"cross_p50\":%.2f}",
			r->stretches, r->drift_p50_m_per_km, r->drift_p95_m_per_km, r->drift_max_m_per_km, r->along_p50_m_per_km,
			r->cross_p50_m_per_km);
	printf(",\n \"yaw_bias_deg_s\":%.4f, \"speed_scale\":%.5f}\n", r->yaw_bias_deg_s, r->speed_scale);
}

static int run(const struct arguments *arguments, const struct car *car, const struct pkg *pkg)
{
	struct track_options options = {
		.log = arguments->log, .use_gnss = arguments->gnss, .free = arguments->free, .step_s = arguments->step_s
	};
	struct truth truth = { 0 };
	struct track_result result;
	options.pkg = arguments->city ? pkg : NULL;
	if (arguments->truth && truth_read(&truth, arguments->truth, &pkg->graph)) {
		truth_finish(&truth);
		return EXIT_BAD_INPUT;
	}
	options.truth = arguments->truth ? &truth : NULL;
	if (arguments->trace && !(options.trace = fopen(arguments->trace, "w"))) {
		log_error("%s: %s", arguments->trace, strerror(errno));
		truth_finish(&truth);
		return EXIT_FAILED;
	}
	if (options.trace)
		fputs("time_s,east_m,north_m,up_m,heading_deg,speed_mps,half,along_m,on_street,confidence,uncertainty_m,route,"
			  "remaining_m,next,next_m,reroutes\n",
			options.trace);
	int err = track_log(car, &options, &result);
	if (!err)
		print_result(&result, arguments->city, arguments->truth);
	if (options.trace)
		fclose(options.trace);
	truth_finish(&truth);
	return err ? EXIT_BAD_INPUT : EXIT_DONE;
}

int cmd_track(int argc, char **argv)
{
	static const struct argp argp = { option_list, parse_option, "LOG.candump",
		"Follows a recorded drive and tells how well, as JSON.", NULL, NULL, NULL };
	struct arguments arguments = { 0 };
	if (argp_parse(&argp, argc, argv, 0, NULL, &arguments))
		return EXIT_USAGE;
	size_t bytes = (size_t)16 << 20;
	uint8_t *memory = malloc(bytes);
	if (!memory)
		abort();
	struct arena arena;
	arena_init(&arena, "car", memory, bytes);
	struct pkg pkg = { 0 };
	struct profile *profile = calloc(1, sizeof(*profile));
	struct car *car = calloc(1, sizeof(*car));
	if (!profile || !car)
		abort();
	int status = EXIT_BAD_INPUT;
	struct pkg_fault fault = { 0 };
	int err = arguments.city ? pkg_open(&pkg, arguments.city, &fault) : 0;
	if (err)
		log_error("%s: %s", arguments.city, err == -EBADMSG ? fault.text : strerror(-err));
	else if (!profile_load(profile, arguments.profile, &arena) &&
			 !car_init(car, profile, arguments.dbc, arguments.dbc_count, NULL, 0, &arena))
		status = run(&arguments, car, &pkg);
	if (arguments.city && !err)
		pkg_close(&pkg);
	free(car);
	free(profile);
	free(memory);
	return status;
}
