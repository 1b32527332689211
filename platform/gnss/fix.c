/* Reads one object of names and plain values, as far as it is well formed; nested ones are passed over. */
#include "platform/gnss/fix.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define NUMBER_MAX 40
#define DEPTH_MAX 16
#define PI 3.14159265358979323846
#define SIGMA_SHARE (1.0 / 2.45) /* eph is 95 % of a plane: 2.45 sigma */
#define MOVING_MPS 1.5           /* the course of a standing receiver is noise */

struct reader {
	const char *at, *end;
};

struct text {
	const char *at;
	size_t size;
};

static void skip_blanks(struct reader *in)
{
	while (in->at < in->end && (*in->at == ' ' || *in->at == '\t' || *in->at == '\r' || *in->at == '\n'))
		in->at++;
}

static bool take(struct reader *in, char c)
{
	skip_blanks(in);
	if (in->at == in->end || *in->at != c)
		return false;
	in->at++;
	return true;
}

/* Between the quotes, escapes as they are: no name or word of ours has any. */
static bool take_string(struct reader *in, struct text *out)
{
	if (!take(in, '"'))
		return false;
	out->at = in->at;
	while (in->at < in->end && *in->at != '"')
		in->at += *in->at == '\\' && in->end - in->at > 1 ? 2 : 1;
	if (in->at >= in->end)
		return false;
	out->size = (size_t)(in->at - out->at);
	in->at++;
	return true;
}

/* An array or object, to its end. */
static bool skip_nested(struct reader *in)
{
	int depth = 0;
	struct text string;
	while (in->at < in->end) {
		char c = *in->at;
		if (c == '"') {
			if (!take_string(in, &string))
				return false;
			continue;
		}
		depth += (c == '{' || c == '[') - (c == '}' || c == ']');
		in->at++;
		if (depth == 0)
			return true;
		if (depth > DEPTH_MAX)
			return false;
	}
	return false;
}

/* A value: its text, without quotes; nested ones are empty. */
static bool take_value(struct reader *in, struct text *out)
{
	*out = (struct text){ 0 };
	skip_blanks(in);
	if (in->at == in->end)
		return false;
	if (*in->at == '"')
		return take_string(in, out);
	if (*in->at == '{' || *in->at == '[')
		return skip_nested(in);
	out->at = in->at;
	while (in->at < in->end && *in->at != ',' && *in->at != '}' && *in->at != ' ' && *in->at != '\r' && *in->at != '\n')
		in->at++;
	out->size = (size_t)(in->at - out->at);
	return out->size > 0;
}

static bool is(struct text text, const char *word)
{
	return text.size == strlen(word) && !memcmp(text.at, word, text.size);
}

static double number_of(struct text text)
{
	char copy[NUMBER_MAX], *end;
	if (!text.size || text.size >= sizeof(copy) || (*text.at != '-' && (*text.at < '0' || *text.at > '9')))
		return (double)NAN;
	memcpy(copy, text.at, text.size);
	copy[text.size] = 0;
	double value = strtod(copy, &end);
	return *end ? (double)NAN : value;
}

/* "2024-06-21T08:30:00.000Z" */
static int64_t utc_of(struct text text)
{
	char copy[NUMBER_MAX];
	struct tm tm = { 0 };
	double seconds;
	if (!text.size || text.size >= sizeof(copy))
		return 0;
	memcpy(copy, text.at, text.size);
	copy[text.size] = 0;
	if (sscanf(copy, "%4d-%2d-%2dT%2d:%2d:%lf", &tm.tm_year, &tm.tm_mon, &tm.tm_mday, &tm.tm_hour, &tm.tm_min,
			&seconds) != 6 ||
		tm.tm_year < 1970 || tm.tm_year > 2200 || tm.tm_mon < 1 || tm.tm_mon > 12 ||
		!(seconds >= 0.0 && seconds < 61.0))
		return 0;
	tm.tm_year -= 1900;
	tm.tm_mon--;
	return (int64_t)timegm(&tm) * INT64_C(1000000000) + (int64_t)(seconds * 1e9);
}

/* What a TPV says that matters here; NAN what it does not. */
struct report {
	bool is_tpv;
	double mode, lat, lon, eph, epx, epy, track, speed;
	int64_t utc_ns;
};

static void take_member(struct report *report, struct text name, struct text value)
{
	const struct {
		const char *name;
		double *to;
	} numbers[] = { { "mode", &report->mode }, { "lat", &report->lat }, { "lon", &report->lon },
		{ "eph", &report->eph }, { "epx", &report->epx }, { "epy", &report->epy }, { "track", &report->track },
		{ "speed", &report->speed } };
	if (is(name, "class"))
		report->is_tpv = is(value, "TPV");
	if (is(name, "time"))
		report->utc_ns = utc_of(value);
	for (size_t i = 0; i < sizeof(numbers) / sizeof(numbers[0]); i++)
		if (is(name, numbers[i].name))
			*numbers[i].to = number_of(value);
}

static bool read_report(struct reader *in, struct report *report)
{
	struct text name, value;
	if (!take(in, '{'))
		return false;
	if (take(in, '}'))
		return true;
	do {
		if (!take_string(in, &name) || !take(in, ':') || !take_value(in, &value))
			return false;
		take_member(report, name, value);
	} while (take(in, ','));
	return take(in, '}');
}

static double sigma_of(const struct report *report)
{
	if (report->eph > 0.0 && report->eph < 1e5)
		return report->eph * SIGMA_SHARE;
	double planar = hypot(report->epx, report->epy); /* 95 % of a line each: 2 sigma */
	return planar > 0.0 && planar < 1e5 ? 0.5 * planar : 0.0;
}

enum gnss_line gnss_parse(const char *text, size_t size, struct gnss_fix *out)
{
	struct reader in = { text, text + size };
	const double none = (double)NAN;
	struct report report = { false, none, none, none, none, none, none, none, none, 0 };
	if (!read_report(&in, &report) || !report.is_tpv)
		return GNSS_LINE_OTHER;
	if (!(report.mode >= 2.0))
		return GNSS_LINE_NO_FIX;
	if (!(fabs(report.lat) <= 90.0) || !(fabs(report.lon) <= 360.0))
		return GNSS_LINE_OTHER;
	*out = (struct gnss_fix){
		.utc_ns = report.utc_ns,
		.lat_deg = report.lat,
		.lon_deg = report.lon,
		.sigma_m = sigma_of(&report),
		.speed_mps = report.speed >= 0.0 && report.speed < 400.0 ? report.speed : -1.0,
		.has_course = report.track >= 0.0 && report.track <= 360.0 && report.speed > MOVING_MPS,
	};
	if (out->has_course)
		out->course_rad = report.track * (PI / 180.0);
	return GNSS_LINE_FIX;
}
