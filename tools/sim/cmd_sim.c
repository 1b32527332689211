/* blvd sim: arguments, and the loop in real time. */
#include <argp.h>
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "platform/base/clock.h"
#include "platform/base/log.h"
#include "platform/can/can_bus.h"
#include "tools/commands.h"
#include "tools/drive/drive_arguments.h"
#include "tools/sim/child.h"
#include "tools/sim/devices.h"
#include "tools/sim/keys.h"
#include "tools/sim/sim.h"

#define TICK_NS BUS_TICK_NS
#define LATE_NS (200 * NS_PER_MS) /* later than this the car has stood still meanwhile */
#define SHOW_TICKS 20
#define MEET_NS (60 * NS_PER_S)
#define MEET_STEP_NS (20 * NS_PER_MS)
#define NOBODYS_ID 0x7FFu
#define SCRIPTS_MAX 64
#define BUS_BYTES ((size_t)4 << 20)

enum {
	KEY_CAN = 256,
	KEY_VIA,
	KEY_START,
	KEY_SEED,
	KEY_MINUTES,
	KEY_SPEED,
	KEY_WAIT,
	KEY_NO_GNSS,
	KEY_FAULT,
	KEY_CONTROL,
	KEY_GPIO,
	KEY_CAMERA,
	KEY_SET_CLOCK,
	KEY_RUN,
	KEY_HAND,
	KEY_AUTO,
};

struct arguments {
	struct sim_options sim;
	const char *package, *can, *control, *gpio, *camera;
	const char *scripts[SCRIPTS_MAX];
	unsigned script_count;
	const char *const *child_arguments; /* after -- */
	bool run, set_clock, hand, automatic, seeded;
};

static const struct argp_option option_list[] = {
	{ "can", KEY_CAN, "INTERFACE", 0, "where the car's bus is: vcan0, or unix:PATH where the kernel has no CAN", 0 },
	{ "run", KEY_RUN, NULL, 0, "start boulevard too; what follows -- are its options", 0 },
	{ "drive", KEY_AUTO, NULL, 0, "along a route; default with --via, --seed or --minutes, or without a terminal", 0 },
	{ "hand", KEY_HAND, NULL, 0, "by hand, also with these; default on a terminal", 0 },
	{ "via", KEY_VIA, "LAT,LON", 0, "drive there; up to 8 times, the last one is the destination", 0 },
	{ "start", KEY_START, "LAT,LON", 0, "start there; default: the seed chooses", 0 },
	{ "seed", KEY_SEED, "N", 0, "chooses the tour, signals and errors; default 1", 0 },
	{ "minutes", KEY_MINUTES, "M", 0, "end after M minutes", 0 },
	{ "speed", KEY_SPEED, "FACTOR", 0, "along the route, 0.1 to 3; default 1", 0 },
	{ "wait", KEY_WAIT, "SECONDS", 0, "stand before setting off along the route; default 5", 0 },
	{ "no-gnss", KEY_NO_GNSS, NULL, 0, "no satellite fixes but the first ones", 0 },
	{ "fault", KEY_FAULT, "TIME:KIND[:TARGET][/SECONDS]", 0, "a fault at a time, in seconds; may stand often", 0 },
	{ "control", KEY_CONTROL, "PIPE", 0, "take commands from there too; made when it is not there", 0 },
	{ "gpio", KEY_GPIO, "PATH", 0, "lines: a pipe for boulevard --gpio sim:PATH, or a folder of pin-NAME files", 0 },
	{ "camera", KEY_CAMERA, "PIPE", 0, "where the simulated camera takes its faults", 0 },
	{ "set-clock", KEY_SET_CLOCK, NULL, 0, "a clock fault sets this machine's clock too (as root)", 0 },
	{ 0 },
};

/* --- arguments --- */

static error_t parse_route(int key, char *arg, struct arguments *out, struct argp_state *state)
{
	struct drive_options *drive = &out->sim.drive;
	switch (key) {
	case KEY_VIA:
		if (drive->via_count == DESTINATION_STOPS_MAX)
			argp_error(state, "at most %d times --via", DESTINATION_STOPS_MAX);
		drive->via[drive->via_count++] = argument_place(arg, state);
		return 0;
	case KEY_START:
		drive->start = argument_place(arg, state);
		drive->has_start = true;
		return 0;
	case KEY_SEED:
		drive->seed = argument_seed(arg, state);
		out->seeded = true;
		return 0;
	case KEY_MINUTES:
		drive->minutes = argument_number(arg, 0.05, 600.0, state);
		return 0;
	case KEY_SPEED:
		out->sim.factor = argument_number(arg, 0.1, 3.0, state);
		return 0;
	case KEY_WAIT:
		out->sim.wait_s = argument_number(arg, 0.0, 3600.0, state);
		return 0;
	case KEY_NO_GNSS:
		drive->gnss = false;
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static error_t parse_world(int key, char *arg, struct arguments *out, struct argp_state *state)
{
	switch (key) {
	case KEY_CAN:
		out->can = arg;
		return 0;
	case KEY_FAULT:
		if (out->script_count == SCRIPTS_MAX)
			argp_error(state, "at most %d times --fault", SCRIPTS_MAX);
		out->scripts[out->script_count++] = arg;
		return 0;
	case KEY_CONTROL:
		out->control = arg;
		return 0;
	case KEY_GPIO:
		out->gpio = arg;
		return 0;
	case KEY_CAMERA:
		out->camera = arg;
		return 0;
	case KEY_SET_CLOCK:
		out->set_clock = true;
		return 0;
	case KEY_RUN:
		out->run = true;
		return 0;
	case KEY_HAND:
		out->hand = true;
		return 0;
	case KEY_AUTO:
		out->automatic = true;
		return 0;
	case ARGP_KEY_ARG:
		if (out->package)
			argp_error(state, "one package, please; boulevard's options come after --");
		out->package = arg;
		return 0;
	case ARGP_KEY_END:
		if (!out->package)
			argp_error(state, "a package is needed");
		if (!out->can && !out->run)
			argp_error(state, "--can INTERFACE, or --run, is needed");
		return 0;
	default:
		return ARGP_ERR_UNKNOWN;
	}
}

static error_t parse_option(int key, char *arg, struct argp_state *state)
{
	error_t status = parse_route(key, arg, state->input, state);
	return status == ARGP_ERR_UNKNOWN ? parse_world(key, arg, state->input, state) : status;
}

/* Everything after -- is boulevard's. */
static int cut_child_arguments(struct arguments *out, int argc, char **argv)
{
	static const char *const none[] = { NULL };
	out->child_arguments = none;
	for (int i = 1; i < argc; i++) {
		if (strcmp(argv[i], "--") != 0)
			continue;
		out->child_arguments = (const char *const *)argv + i + 1;
		argv[i] = NULL;
		return i;
	}
	return argc;
}

/* --- the world --- */

struct session {
	struct arguments *arguments;
	struct sim sim;
	struct sim_world world;
	struct can_bus *bus;
	struct keys keys, control; /* `control` is a pipe */
	struct devices devices;
	struct child child;
	char own_bus[64];
	uint64_t sent, lost;
	bool told_down;
};

static volatile sig_atomic_t stop_asked;

static void on_signal(int number)
{
	(void)number;
	stop_asked = 1;
}

static void catch_signals(void)
{
	struct sigaction action = { .sa_handler = on_signal };
	sigaction(SIGINT, &action, NULL);
	sigaction(SIGTERM, &action, NULL);
	sigaction(SIGHUP, &action, NULL);
	signal(SIGPIPE, SIG_IGN);
}

static void set_clock(double by_s)
{
	int64_t wall_ns = clock_wall_ns() + (int64_t)(by_s * 1e9);
	struct timespec time = { .tv_sec = (time_t)(wall_ns / NS_PER_S), .tv_nsec = (long)(wall_ns % NS_PER_S) };
	if (clock_settime(CLOCK_REALTIME, &time) < 0)
		log_warn("the clock cannot be set: %s", strerror(errno));
}

static void on_fault(void *context, const struct fault_event *event)
{
	struct session *session = context;
	devices_fault(&session->devices, event);
	if (event->kind == FAULT_CLOCK && event->begins && session->arguments->set_clock)
		set_clock(strtod(event->target, NULL));
}

static void on_line(void *context, const char *name, bool on)
{
	struct session *session = context;
	/* the virtual car's ignition is on the bus; a pipe's reader need not know such a line */
	if (session->devices.folder || strcmp(name, "ignition") != 0)
		devices_line(&session->devices, name, on);
}

static bool kernel_has_can(void)
{
	int fd = socket(AF_CAN, SOCK_RAW | SOCK_CLOEXEC, 1);
	if (fd >= 0)
		close(fd);
	return fd >= 0;
}

static int open_bus(struct session *session, struct arena *arena)
{
	struct arguments *arguments = session->arguments;
	if (!arguments->can) {
		snprintf(session->own_bus, sizeof(session->own_bus), "car=unix:@blvd-sim-%d", (int)getpid());
		arguments->can = session->own_bus;
	}
	const struct can_bus_config config = { .interfaces = &arguments->can, .interface_count = 1 };
	int status = can_bus_open(&session->bus, &can_live_ops, &config, arena);
	if (status)
		log_error("%s: cannot open: %s%s", arguments->can, strerror(-status),
			!kernel_has_can() ? "; this kernel has no CAN: use --can unix:PATH on both sides" : "");
	return status;
}

/* Opened for both ways, so that it never ends. */
static int open_control(struct session *session)
{
	const char *path = session->arguments->control;
	session->control.in = -1;
	if (!path)
		return 0;
	struct stat info;
	int fd = -1;
	if ((mkfifo(path, 0600) == 0 || errno == EEXIST) && stat(path, &info) == 0 && S_ISFIFO(info.st_mode))
		fd = open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC);
	if (fd < 0) {
		log_error("%s: cannot be a pipe for commands: %s", path, strerror(errno ? errno : EINVAL));
		return -1;
	}
	session->control = (struct keys){ .in = fd };
	return 0;
}

static int start_child(struct session *session)
{
	struct arguments *arguments = session->arguments;
	const char *all[CHILD_ARGUMENTS_MAX] = { "--can", arguments->can };
	char gpio[100], camera[100];
	size_t count = 2;
	if (!arguments->run)
		return 0;
	if (!arguments->camera) {
		arguments->camera = session->child.camera;
		snprintf(camera, sizeof(camera), "sim:control=%s", session->child.camera);
		all[count++] = "--camera";
		all[count++] = camera;
	}
	if (!arguments->gpio) {
		arguments->gpio = session->child.gpio;
		snprintf(gpio, sizeof(gpio), "sim:%s", session->child.gpio);
		all[count++] = "--gpio";
		all[count++] = gpio;
	}
	for (const char *const *a = arguments->child_arguments; *a && count + 1 < CHILD_ARGUMENTS_MAX; a++)
		all[count++] = *a;
	return child_start(&session->child, arguments->package, all);
}

static int add_scripts(struct session *session)
{
	for (unsigned i = 0; i < session->arguments->script_count; i++) {
		const char *wrong = faults_script(&session->sim.faults, session->arguments->scripts[i]);
		if (!wrong)
			continue;
		log_error("--fault %s: %s", session->arguments->scripts[i], wrong);
		return -1;
	}
	return 0;
}

/* --- the loop --- */

static void hear(struct session *session, struct keys *from)
{
	for (const char *command; (command = keys_next(from));) {
		const char *wrong = sim_say(&session->sim, &session->world, command);
		if (!wrong)
			continue;
		if (session->keys.terminal)
			fputs("\r\033[K", stderr);
		log_warn("%s: %s", command, wrong);
	}
}

static void show(struct session *session)
{
	const struct sim *sim = &session->sim;
	const struct pkg *pkg = sim->drive.pkg;
	const struct drive_state *state = &sim->state;
	static const char letters[] = "?PRND";
	char faults[120], line[320];
	enum nav_gear gear = state->gear != NAV_GEAR_UNKNOWN ? state->gear : state->parked ? NAV_GEAR_PARK : NAV_GEAR_DRIVE;
	faults_describe(&sim->faults, sim->time_s, faults, sizeof(faults));
	snprintf(line, sizeof(line), "%s%c %3.0f km/h  %s%s%s%s%s%s%s", sim->ignition ? "" : "ignition off  ",
		letters[gear], fabs(state->speed_mps) * 3.6, state->lamp < 0 || state->lamp > 1 ? "< " : "",
		state->lamp > 0 ? "> " : "", pkg_string(pkg, graph_edge(&sim->drive.graph, state->half)->name),
		sim->by_hand ? "" : "  (route)", session->told_down ? "  nobody listens" : "", faults[0] ? "  FAULTS: " : "",
		faults);
	keys_show(&session->keys, line);
}

/* A bus without a listener loses what is said; that is told once. */
static void send_frames(struct session *session, int64_t due_ns, int64_t wall_ns)
{
	for (unsigned i = 0; i < session->sim.frame_count; i++) {
		struct can_frame_rx *frame = &session->sim.frames[i];
		clock_sleep_until(due_ns + frame->time_ns - wall_ns);
		frame->bus = 0;
		int status = can_bus_write(session->bus, frame);
		session->sent += status == 0;
		session->lost += status != 0;
		if (status && !session->told_down && status != -ENOBUFS && !session->arguments->run)
			log_info("nobody listens on %s yet%s", session->arguments->can,
				status == -ENODEV ? ": is the interface there?" : "");
		session->told_down = status != 0 && status != -ENOBUFS;
	}
}

static void drain(struct session *session)
{
	struct can_frame_rx frames[32];
	while (can_bus_read(session->bus, INT64_MAX, frames, 32) > 0)
		;
}

static bool is_over(struct session *session)
{
	const struct sim *sim = &session->sim;
	const struct arguments *arguments = session->arguments;
	double minutes = arguments->sim.drive.minutes;
	if (stop_asked || sim->quit || (arguments->run && !child_runs(&session->child)))
		return true;
	if (minutes > 0.0 && sim->time_s >= minutes * 60.0 + arguments->sim.wait_s)
		return true;
	return sim->ended && !session->keys.terminal; /* before a driver it stays parked */
}

/* A child takes a moment to start: the drive begins when it hears something. */
static void meet_child(struct session *session)
{
	const struct can_frame_rx nothing = { .id = NOBODYS_ID };
	int64_t until_ns = clock_now_ns() + MEET_NS;
	while (session->arguments->run && !stop_asked && clock_now_ns() < until_ns && child_runs(&session->child) &&
		   can_bus_write(session->bus, &nothing) != 0)
		clock_sleep_until(clock_now_ns() + MEET_STEP_NS);
}

static void run(struct session *session)
{
	meet_child(session);
	int64_t due_ns = clock_now_ns();
	while (!is_over(session)) {
		clock_sleep_until(due_ns);
		int64_t now_ns = clock_now_ns(), wall_ns = clock_wall_ns();
		if (now_ns - due_ns > LATE_NS)
			due_ns = now_ns;
		hear(session, &session->keys);
		hear(session, &session->control);
		sim_tick(&session->sim, wall_ns, &session->world);
		send_frames(session, due_ns, wall_ns);
		devices_step(&session->devices);
		drain(session);
		if (session->sim.tick % SHOW_TICKS == 0)
			show(session);
		due_ns += TICK_NS;
	}
}

static void greet(const struct session *session)
{
	const struct arguments *arguments = session->arguments;
	if (!arguments->run)
		log_info("the car is on %s; in another terminal: boulevard %s --can %s", arguments->can, arguments->package,
			arguments->can);
	if (session->keys.terminal)
		fputs(keys_help, stderr);
}

static int drive(struct session *session, struct arena *arena)
{
	struct arguments *arguments = session->arguments;
	if (arguments->run && child_prepare(&session->child))
		return EXIT_FAILED;
	if (open_bus(session, arena) || open_control(session) || start_child(session))
		return EXIT_FAILED;
	if (devices_open(&session->devices, arguments->gpio, arguments->camera))
		return EXIT_BAD_INPUT;
	session->world =
		(struct sim_world){ .line = arguments->gpio ? on_line : NULL, .fault = on_fault, .context = session };
	keys_open(&session->keys);
	greet(session);
	run(session);
	keys_close(&session->keys);
	return EXIT_DONE;
}

static int simulate(struct arguments *arguments, const struct pkg *pkg, struct arena *arena)
{
	static struct session session;
	int status = EXIT_FAILED;
	session.arguments = arguments;
	session.control.in = -1;
	if (sim_init(&session.sim, arena, pkg, &arguments->sim) == 0)
		status = add_scripts(&session) ? EXIT_USAGE : drive(&session, arena);
	int child = child_end(&session.child);
	can_bus_close(session.bus);
	if (session.control.in >= 0)
		close(session.control.in);
	if (status == EXIT_DONE)
		log_info("%.0f s, %.2f km, %llu frames sent, %llu nobody took, %llu withheld by faults", session.sim.time_s,
			session.sim.state.odometer_m * 1e-3, (unsigned long long)session.sent, (unsigned long long)session.lost,
			(unsigned long long)session.sim.withheld);
	sim_finish(&session.sim);
	return status == EXIT_DONE ? child : status;
}

int cmd_sim(int argc, char **argv)
{
	static const struct argp argp = { option_list, parse_option, "CITY.blvd [-- BOULEVARD-OPTION...]",
		"The virtual car, live on a CAN bus: driven from the keyboard or along a route, with faults on command.", NULL,
		NULL, NULL };
	struct arguments arguments = { .sim = {
									   .drive = { .seed = 1, .gnss = true, .speed_error = NAN, .yaw_bias_rps = NAN },
									   .factor = 1.0,
									   .wait_s = 5.0 } };
	argc = cut_child_arguments(&arguments, argc, argv);
	if (argp_parse(&argp, argc, argv, 0, NULL, &arguments))
		return EXIT_USAGE;
	struct drive_options *options = &arguments.sim.drive;
	bool route = arguments.automatic || options->via_count || options->minutes > 0.0 || arguments.seeded;
	arguments.sim.by_hand = arguments.hand || (!route && isatty(STDIN_FILENO));
	options->wall_ns = clock_wall_ns();
	struct pkg pkg;
	struct pkg_fault fault;
	int err = pkg_open(&pkg, arguments.package, &fault);
	if (err) {
		log_error("%s: %s (byte %llu)", arguments.package, err == -EBADMSG ? fault.text : strerror(-err),
			(unsigned long long)fault.offset);
		return EXIT_BAD_INPUT;
	}
	size_t bytes = drive_bytes(&pkg.graph) + BUS_BYTES;
	uint8_t *memory = malloc(bytes);
	if (!memory)
		abort();
	struct arena arena;
	arena_init(&arena, "sim", memory, bytes);
	catch_signals();
	int status = EXIT_BAD_INPUT;
	if (!pkg.graph.edge_count)
		log_error("%s: no streets", arguments.package);
	else
		status = simulate(&arguments, &pkg, &arena);
	free(memory);
	pkg_close(&pkg);
	return status;
}
