/* Pure functions, called a few times a frame. */
#include "render/wording.h"

#include <math.h>
#include <stdio.h>

#include "platform/base/clock.h"

enum wording_units wording_units_of(const struct pkg_meta *meta)
{
	double lat = meta->origin_lat_deg, lon = meta->origin_lon_deg;
	bool states = meta->right_hand_traffic && ((lat > 24.4 && lat < 49.0 && lon > -125.0 && lon < -66.9) ||
												  (lat > 51.0 && lon > -170.0 && lon < -141.0) ||
												  (lat > 18.5 && lat < 22.5 && lon > -161.0 && lon < -154.5));
	bool kingdom = !meta->right_hand_traffic && lat > 49.8 && lat < 61.0 && lon > -8.2 && lon < 1.8;
	return states ? UNITS_MILES_FEET : kingdom ? UNITS_MILES_YARDS : UNITS_METRIC;
}

static void write_long(char *out, double distance, const char *unit)
{
	double tenths = floor(distance * 10.0 + 0.5);
	if (tenths < 100.0)
		snprintf(out, WORDING_MAX, "%d.%d %s", (int)tenths / 10, (int)tenths % 10, unit);
	else
		snprintf(out, WORDING_MAX, "%.0f %s", fmin(floor(distance + 0.5), 99999.0), unit);
}

/* Steps of 10 up to 100, then of 50. */
static void write_short(char *out, double distance, const char *unit)
{
	double step = distance < 95.0 ? 10.0 : 50.0;
	snprintf(out, WORDING_MAX, "%d %s", (int)(floor(distance / step + 0.5) * step), unit);
}

void wording_distance(char *out, double distance_m, enum wording_units units)
{
	const double mile_m = 1609.344;
	if (!(distance_m >= 10.0))
		snprintf(out, WORDING_MAX, "Now");
	else if (units == UNITS_METRIC || units == UNITS_AUTO) {
		if (distance_m < 975.0)
			write_short(out, distance_m, "m");
		else
			write_long(out, distance_m / 1000.0, "km");
	} else if (distance_m > 0.15 * mile_m)
		write_long(out, distance_m / mile_m, "mi");
	else if (units == UNITS_MILES_FEET)
		snprintf(out, WORDING_MAX, "%d ft", (int)(floor(distance_m / 0.3048 / 50.0 + 0.5) * 50.0));
	else
		write_short(out, distance_m / 0.9144, "yd");
}

void wording_duration(char *out, double seconds)
{
	int minutes = (int)fmin(fmax(floor(seconds / 60.0 + 0.5), 1.0), 99.0 * 60.0);
	if (minutes < 60)
		snprintf(out, WORDING_MAX, "%d min", minutes);
	else
		snprintf(out, WORDING_MAX, "%d h %02d min", minutes / 60, minutes % 60);
}

void wording_clock(char *out, int64_t wall_ns, int32_t offset_minutes)
{
	const int64_t day = 24 * 60;
	int64_t minute = (wall_ns / (60 * NS_PER_S) + offset_minutes) % day;
	minute = minute < 0 ? minute + day : minute;
	snprintf(out, WORDING_MAX, "%02d:%02d", (int)(minute / 60), (int)(minute % 60));
}

int wording_speed(double speed_mps, enum wording_units units)
{
	double factor = units == UNITS_METRIC || units == UNITS_AUTO ? 3.6 : 2.2369363;
	return (int)fmin(floor(fabs(speed_mps) * factor + 0.5), 999.0);
}

const char *wording_speed_unit(enum wording_units units)
{
	return units == UNITS_METRIC || units == UNITS_AUTO ? "km/h" : "mph";
}

int wording_limit(int32_t limit_kmh, enum wording_units units)
{
	if (units == UNITS_METRIC || units == UNITS_AUTO)
		return limit_kmh;
	return (int)(floor(limit_kmh / 1.609344 / 5.0 + 0.5) * 5.0);
}

void wording_manoeuvre(char *out, enum nav_manoeuvre manoeuvre, unsigned exit)
{
	static const char *const words[] = {
		[NAV_MANOEUVRE_NONE] = "Follow the route",
		[NAV_MANOEUVRE_STRAIGHT] = "Straight on",
		[NAV_MANOEUVRE_SLIGHT_LEFT] = "Slight left",
		[NAV_MANOEUVRE_LEFT] = "Turn left",
		[NAV_MANOEUVRE_SHARP_LEFT] = "Sharp left",
		[NAV_MANOEUVRE_SLIGHT_RIGHT] = "Slight right",
		[NAV_MANOEUVRE_RIGHT] = "Turn right",
		[NAV_MANOEUVRE_SHARP_RIGHT] = "Sharp right",
		[NAV_MANOEUVRE_U_TURN] = "Turn around",
		[NAV_MANOEUVRE_ROUNDABOUT] = "Roundabout",
		[NAV_MANOEUVRE_KEEP_LEFT] = "Keep left",
		[NAV_MANOEUVRE_KEEP_RIGHT] = "Keep right",
		[NAV_MANOEUVRE_MERGE] = "Merge",
		[NAV_MANOEUVRE_ARRIVE] = "Destination",
	};
	if (manoeuvre == NAV_MANOEUVRE_ROUNDABOUT && exit > 0)
		snprintf(out, WORDING_MAX, "Take exit %u", exit);
	else
		snprintf(out, WORDING_MAX, "%s",
			(size_t)manoeuvre < sizeof(words) / sizeof(words[0]) ? words[manoeuvre] : words[NAV_MANOEUVRE_NONE]);
}

/* Inputs in the order of what their loss costs the driver. Latitude stands for the position receiver. */
static const struct {
	enum nav_signal signal;
	const char *name;
	bool needed; /* worth a line when it was never seen */
	bool aid;    /* dead reckoning does without it: worth a line only when the position has become doubtful */
} inputs[] = {
	{ NAV_SIGNAL_SPEED, "Speed signal", true, false },
	{ NAV_SIGNAL_YAW_RATE, "Turn rate", true, false },
	{ NAV_SIGNAL_HEADING, "Heading", true, true },
	{ NAV_SIGNAL_STEERING, "Steering angle", false, true },
	{ NAV_SIGNAL_LATITUDE, "GPS", true, true },
	{ NAV_SIGNAL_GEAR, "Gear signal", false, false },
	{ NAV_SIGNAL_ODOMETER, "Odometer", false, true },
};

#define DOUBT_M 12.0

/* Whether the driver would steer better knowing that an aid is missing. */
static bool position_is_doubtful(const struct nav_view *nav)
{
	return nav->uncertainty_m > DOUBT_M || !nav->on_street;
}

static bool input_words(char *out, const struct nav_view *nav, size_t row)
{
	enum nav_signal_state state = nav->signal[inputs[row].signal];
	int64_t age_s = nav->signal_age_ns[inputs[row].signal] / NS_PER_S;
	const char *name = inputs[row].name;
	if (state == NAV_SIGNAL_STALE && age_s < 3600)
		snprintf(out, WORDING_MAX, "%s lost %d s", name, (int)age_s);
	else if (state == NAV_SIGNAL_STALE)
		snprintf(out, WORDING_MAX, "%s lost", name);
	else if (state == NAV_SIGNAL_IMPLAUSIBLE)
		snprintf(out, WORDING_MAX, "%s implausible", name);
	else if (state == NAV_SIGNAL_WAITING && inputs[row].needed)
		snprintf(out, WORDING_MAX, "%s: none yet", name);
	else
		return false;
	return true;
}

static bool bus_words(char *out, const struct nav_view *nav)
{
	static const char *const words[] = { [NAV_BUS_ERRORS] = "errors", [NAV_BUS_OFF] = "off", [NAV_BUS_DOWN] = "down" };
	int64_t age_s = nav->bus_age_ns / NS_PER_S;
	if (nav->bus == NAV_BUS_GOOD)
		return false;
	if (age_s < 3600)
		snprintf(out, WORDING_MAX, "Bus %s %s %d s", nav->bus_name, words[nav->bus], (int)age_s);
	else
		snprintf(out, WORDING_MAX, "Bus %s %s", nav->bus_name, words[nav->bus]);
	return true;
}

bool wording_inputs(char *out, const struct nav_view *nav)
{
	if (bus_words(out, nav)) /* why the signals are missing */
		return true;
	if (!nav->located) {
		snprintf(out, WORDING_MAX, "No position");
		return true;
	}
	for (size_t i = 0; i < sizeof(inputs) / sizeof(inputs[0]); i++)
		if ((!inputs[i].aid || position_is_doubtful(nav)) && input_words(out, nav, i))
			return true;
	return false;
}

bool wording_place(char *out, const struct nav_view *nav, enum wording_units units, const char *after)
{
	const struct nav_doubt *doubt = &nav->doubt;
	bool remembered = doubt->place == NAV_PLACE_REMEMBERED && doubt->major_m > DOUBT_M;
	char distance[WORDING_MAX], age[32] = "";
	if (!nav->located || (doubt->place != NAV_PLACE_DRIFTING && !remembered))
		return false;
	wording_distance(distance, 2.0 * doubt->major_m, units);
	int64_t age_s = doubt->age_ns / NS_PER_S;
	if (!remembered && age_s >= 1 && age_s < 3600)
		snprintf(age, sizeof(age), ", for %d s", (int)age_s);
	if (after)
		snprintf(out, WORDING_MAX, "%.48s, position within %.24s", after, distance);
	else
		snprintf(out, WORDING_MAX, "%s within %.32s%s", remembered ? "Last position," : "Position", distance, age);
	return true;
}
