/*
 * Where the car is and where it goes: the one door to this room. Feeds the vehicle state to dead reckoning (reckon.h)
 * and map matching (match.h), keeps the route (route.h) and what is said about it (guidance.h), and hands out struct
 * nav_view (nav_view.h), a flat snapshot.
 *
 * Times are passed in; nothing here reads a clock or a file. All memory comes from the arena at nav_init(), a few
 * megabytes for a large city (see nav_bytes()). A call to nav_update() does a bounded amount of work: a route search
 * goes on over many calls.
 */
#ifndef BLVD_NAV_NAV_H
#define BLVD_NAV_NAV_H

#include "nav/drift.h"
#include "nav/graph.h"
#include "nav/guidance.h"
#include "nav/match.h"
#include "nav/nav_view.h"
#include "nav/reckon.h"
#include "nav/route.h"

struct vehicle_state;

/* What the car says at one moment, in the units of this room; nav_update() makes it from the vehicle state. */
struct nav_input {
	struct reckon_input motion;
	enum nav_gear gear;
	enum nav_turn_lamp turn_lamp;
	bool heading_valid; /* course of a receiver or a compass */
	double heading_rad;
	bool fix_valid;      /* position of a receiver */
	uint32_t fix_number; /* another number is a new fix; each is used once */
	double lat_deg, lon_deg;
	double fix_sigma_m; /* 0 unknown */
};

/* What is worth keeping from one run to the next. Plain numbers: it is stored (board/position_state.h). */
struct nav_memory {
	double lat_deg, lon_deg, height_m;
	double heading_rad;
	double position_var[3]; /* m^2: east, north, common */
	double heading_var;     /* rad^2 */
	double speed_scale, scale_var;
	double yaw_bias_rps, bias_var;
	uint32_t half; /* of this very package, or PKG_NONE */
	bool on_street;
	double along_m;
};

struct nav_config {
	struct reckon_config reckon;
	uint32_t particles;         /* 0: default of match.h */
	uint64_t seed;              /* of the particles; the same seed, log and package give the same views */
	uint32_t route_capacity;    /* 0: default of route.h */
	uint32_t settle_per_update; /* half-edges a route search may settle in one update; 0: 1500 */
	bool ignore_gnss;           /* for tests: fixes are used to find the start only */
};

struct nav {
	const struct pkg *pkg; /* borrowed */
	struct nav_config config;
	struct graph graph;
	struct reckon reckon; /* its position is the shown one: smooth, pulled towards the matched street */
	struct match match;
	struct route_search search;
	struct route route; /* the one being driven; a copy, so that a new search does not disturb it */
	struct guidance guidance;

	/* where to go; stop_count 0: free drive */
	struct route_place stops[ROUTE_STOPS_MAX];
	uint32_t stop_count, stops_reached;
	bool routed;        /* `route` is valid */
	uint32_t route_at;  /* index of the half-edge being driven */
	double off_route_m; /* driven beside the route */
	bool searching;
	double failed_m; /* driven since a search found nothing; negative: none did */
	uint32_t reroutes;

	double learn_s, learn_rad; /* heading corrections since the last lesson in bias */
	uint32_t fix_number;
	bool fix_used;
	/* stretch between two fixes that teaches the speed's scale */
	struct dvec2 stretch_at;
	double stretch_m, stretch_turn_rad; /* travelled and turned since; stretch_turn_rad < 0: none begun */
	bool heading_known;
	double height_m;

	struct drift drift;
	bool remembered;        /* the place is of the last run and not confirmed */
	double remembered_at_m; /* travelled then */
	bool moved_unseen;      /* since then, and no fix has said where to */
	bool turned_unseen;     /* nor a course where it looks */
	bool was_blind;         /* the speed is not told */
	uint32_t wild_fixes;    /* in a row, off the streets */
	enum nav_place place;
	int64_t sure_ns; /* when the place was last sure; INT64_MIN never */
};

/* Upper bound of what nav_init() takes from the arena for a graph. */
size_t nav_bytes(const struct pkg_graph *net, const struct nav_config *config);

/* `pkg` is borrowed and must be open for as long as `nav` is used. Returns 0 or -ENOMEM. */
int nav_init(struct nav *nav, struct arena *arena, const struct pkg *pkg, const struct nav_config *config);

/* The car stands at a place, facing `heading_deg` (clockwise from north; NAN not known). Returns false when no street
 * is within 150 m. */
bool nav_set_start(struct nav *nav, double lat_deg, double lon_deg, double heading_deg);

/* The same by half-edge. Returns false when there is no such half-edge. */
bool nav_set_start_half(struct nav *nav, uint32_t half, double along_m);

/* What to keep of the present place; false, and nothing written, when there is none. */
bool nav_remember(const struct nav *nav, struct nav_memory *out);

/* Goes on where an earlier run was, with its uncertainty. `same_package`: half-edges mean what they meant then. Returns
 * false, having taken at most what was learned of the sensors, when no street is near that place or it is no place. */
bool nav_restore(struct nav *nav, const struct nav_memory *memory, bool same_package);

/* The car was moved by up to `by_m` without being seen. */
void nav_moved_unseen(struct nav *nav, double by_m);

/* Where to go: `count` stops in order (1 to ROUTE_STOPS_MAX), the last is the destination. Each is taken to the nearest
 * street that cars may use. The search begins with the next update that knows where the car is. Returns false, changing
 * nothing, when a stop is farther than 1 km from any street. */
bool nav_set_stops(struct nav *nav, const struct geo_point *stops, uint32_t count);
bool nav_set_destination(struct nav *nav, double lat_deg, double lon_deg);
bool nav_set_destination_half(struct nav *nav, uint32_t half, double along_m);

/* Free drive: no route. */
void nav_clear_destination(struct nav *nav);

/*
 * Moves on to `now_ns` with what the car says, and tells the state. May be called at any rate; between calls speed and
 * yaw rate are taken to change linearly, so call it at least every 50 ms of driving, also where the picture is slower,
 * then with `out` NULL. `wall_ns` is the time since 1970 UTC, 0 unknown.
 */
void nav_update(
	struct nav *nav, const struct vehicle_state *vehicle, int64_t now_ns, int64_t wall_ns, struct nav_view *out);

/* The view while there is no map yet: the inputs alone. */
void nav_without_map(const struct vehicle_state *vehicle, int64_t now_ns, int64_t wall_ns, struct nav_view *out);

/* The two halves of it, for tools and tests without a bus: nav_snapshot() fills all but the group of inputs, which
 * stays as it is (the lamps and the gear in it tell which way the car may go). */
void nav_advance(struct nav *nav, const struct nav_input *input, int64_t now_ns);
void nav_snapshot(struct nav *nav, struct nav_view *out);

#endif
