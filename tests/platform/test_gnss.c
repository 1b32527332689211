/* Positions from gpsd: its lines, good and hostile, a daemon that comes and goes, and recorded logs. */
#include <arpa/inet.h>
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cmocka.h>

#include "platform/base/clock.h"
#include "platform/base/rng.h"
#include "platform/gnss/gnss.h"

#define assert_near(a, b, by) assert_true(fabs((a) - (b)) <= (by))

static const char tpv[] =
	"{\"class\":\"TPV\",\"device\":\"/dev/"
	"ttyACM0\",\"mode\":3,\"time\":\"2024-06-21T08:30:00.500Z\",\"leapseconds\":18,"
	"\"ept\":0.005,\"lat\":46.204400000,\"lon\":6.143200000,\"altHAE\":421.5,\"epx\":3.1,\"epy\":4.2,\"epv\":11.0,"
	"\"track\":90.0,\"magtrack\":88.2,\"speed\":13.9,\"climb\":0.0,\"eph\":4.9,\"sep\":12.3}";

static enum gnss_line parse(const char *text, struct gnss_fix *fix)
{
	return gnss_parse(text, strlen(text), fix);
}

static void a_report_is_read(void **state)
{
	(void)state;
	struct gnss_fix fix;
	assert_int_equal(parse(tpv, &fix), GNSS_LINE_FIX);
	assert_near(fix.lat_deg, 46.2044, 1e-9);
	assert_near(fix.lon_deg, 6.1432, 1e-9);
	assert_near(fix.sigma_m, 2.0, 0.01); /* 95 % within 4.9 m */
	assert_true(fix.has_course);
	assert_near(fix.course_rad, 1.5707963, 1e-6);
	assert_near(fix.speed_mps, 13.9, 1e-9);
	assert_int_equal(fix.utc_ns, INT64_C(1718958600500000000));
}

static void lines_are_what_they_are(void **state)
{
	(void)state;
	static const struct {
		const char *text;
		enum gnss_line kind;
	} cases[] = {
		{ "{\"class\":\"VERSION\",\"release\":\"3.22\",\"proto_major\":3}", GNSS_LINE_OTHER },
		{ "{\"class\":\"SKY\",\"satellites\":[{\"PRN\":1,\"lat\":5},{\"PRN\":2}],\"uSat\":2}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":1}", GNSS_LINE_NO_FIX },
		{ "{\"class\":\"TPV\",\"mode\":0,\"lat\":1,\"lon\":2}", GNSS_LINE_NO_FIX },
		{ "{\"class\":\"TPV\"}", GNSS_LINE_NO_FIX },
		{ "{\"class\":\"TPV\",\"mode\":2,\"lat\":1,\"lon\":2}", GNSS_LINE_FIX },
		{ " { \"class\" : \"TPV\" , \"mode\" : 3 , \"lat\" : -1.5e0 , \"lon\" : 2 } \r", GNSS_LINE_FIX },
		{ "{\"lat\":1,\"lon\":2,\"mode\":3,\"nested\":{\"lat\":[{}]},\"class\":\"TPV\"}", GNSS_LINE_FIX },
		{ "{\"class\":\"TPV\",\"mode\":3}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":91,\"lon\":2}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":nan,\"lon\":2}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":inf,\"lon\":2}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":1e999,\"lon\":2}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":\"1\",\"lon\":{}}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":1.0000000000000000000000000000000000000000001,\"lon\":2}",
			GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,\"lat\":1,\"lon\":2", GNSS_LINE_OTHER },
		{ "{\"class\":\"TPV\",\"mode\":3,,\"lat\":1,\"lon\":2}", GNSS_LINE_OTHER },
		{ "{\"class\":\"TP\\\"V\",\"mode\":3,\"lat\":1,\"lon\":2}", GNSS_LINE_OTHER },
		{ "$GPRMC,083000,A,4612.26,N,00608.59,E", GNSS_LINE_OTHER },
		{ "{\"a\":[[[[[[[[[[[[[[[[[[[[[[[[]]]]]]]]]]]]]]]]]]]]]]]]}", GNSS_LINE_OTHER },
		{ "{\"a\":\"\\", GNSS_LINE_OTHER },
		{ "{", GNSS_LINE_OTHER },
		{ "{}", GNSS_LINE_OTHER },
		{ "", GNSS_LINE_OTHER },
	};
	for (size_t i = 0; i < sizeof(cases) / sizeof(cases[0]); i++) {
		struct gnss_fix fix;
		if (parse(cases[i].text, &fix) != cases[i].kind)
			fail_msg("%s: %d", cases[i].text, parse(cases[i].text, &fix));
	}
}

static void what_is_not_said_is_unknown(void **state)
{
	(void)state;
	struct gnss_fix fix;
	assert_int_equal(parse("{\"class\":\"TPV\",\"mode\":2,\"lat\":1,\"lon\":2,\"track\":45}", &fix), GNSS_LINE_FIX);
	assert_true(fix.sigma_m == 0.0 && !fix.has_course && fix.speed_mps < 0.0 && fix.utc_ns == 0);
	assert_int_equal(
		parse("{\"class\":\"TPV\",\"mode\":2,\"lat\":1,\"lon\":2,\"track\":45,\"speed\":0.2,\"epx\":6,\"epy\":8,"
			  "\"time\":\"soon\"}",
			&fix),
		GNSS_LINE_FIX);
	assert_true(!fix.has_course && fix.utc_ns == 0); /* the course of a standing receiver is noise */
	assert_near(fix.sigma_m, 5.0, 1e-9);
}

static void damaged_lines_never_give_a_wrong_number(void **state)
{
	(void)state;
	struct rng rng = rng_seed(3);
	char text[sizeof(tpv)];
	for (int i = 0; i < 200000; i++) {
		memcpy(text, tpv, sizeof(tpv));
		size_t size = sizeof(tpv) - 1;
		for (int k = 0; k < 1 + (int)(rng_u32(&rng) % 4); k++)
			text[rng_u32(&rng) % size] = (char)rng_u32(&rng);
		if (rng_u32(&rng) % 4 == 0)
			size = rng_u32(&rng) % size;
		struct gnss_fix fix;
		if (gnss_parse(text, size, &fix) != GNSS_LINE_FIX)
			continue;
		assert_true(fabs(fix.lat_deg) <= 90.0 && fabs(fix.lon_deg) <= 360.0);
		assert_true(fix.sigma_m >= 0.0 && fix.sigma_m < 1e5);
		assert_true(!fix.has_course || (fix.course_rad >= 0.0 && fix.course_rad < 6.3));
	}
}

/* --- a daemon --- */

struct server {
	int listener, peer;
	unsigned port;
};

static void server_start(struct server *server, unsigned port)
{
	struct sockaddr_in address = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port) };
	socklen_t size = sizeof(address);
	int on = 1;
	address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
	server->listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
	setsockopt(server->listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
	assert_int_equal(bind(server->listener, (struct sockaddr *)&address, sizeof(address)), 0);
	assert_int_equal(listen(server->listener, 1), 0);
	assert_int_equal(getsockname(server->listener, (struct sockaddr *)&address, &size), 0);
	server->port = ntohs(address.sin_port);
	server->peer = -1;
}

static void server_say(const struct server *server, const char *text, size_t size)
{
	assert_int_equal(send(server->peer, text, size, MSG_NOSIGNAL), size);
}

static void server_stop(struct server *server)
{
	if (server->peer >= 0)
		close(server->peer);
	if (server->listener >= 0)
		close(server->listener);
	server->peer = server->listener = -1;
}

struct reader {
	uint8_t memory[16384];
	struct gnss *gnss;
	int64_t now_ns;
	struct gnss_fix fix;
	unsigned fixes;
};

static void reader_start(struct reader *reader, unsigned port)
{
	struct arena arena;
	char spec[64];
	memset(reader, 0, sizeof(*reader));
	arena_init(&arena, "gnss", reader->memory, sizeof(reader->memory));
	snprintf(spec, sizeof(spec), "gpsd:127.0.0.1:%u", port);
	assert_int_equal(gnss_open(&reader->gnss, spec, 0, &arena), 0);
}

/* Frames for a while; the loopback delivers at once, but not instantly. */
static void reader_run(struct reader *reader, double seconds)
{
	for (int64_t until = reader->now_ns + (int64_t)(seconds * 1e9); reader->now_ns < until;) {
		reader->now_ns += 20 * NS_PER_MS;
		usleep(100);
		reader->fixes += gnss_read(reader->gnss, reader->now_ns, &reader->fix);
	}
}

static void reader_meets(struct reader *reader, struct server *server)
{
	reader_run(reader, 0.1);
	server->peer = accept4(server->listener, NULL, NULL, SOCK_CLOEXEC);
	assert_true(server->peer >= 0);
	char watch[128] = { 0 };
	reader_run(reader, 0.1);
	assert_true(recv(server->peer, watch, sizeof(watch) - 1, 0) > 0);
	assert_non_null(strstr(watch, "?WATCH={\"enable\":true,\"json\":true}"));
}

static void a_daemon_is_heard_line_by_line_however_it_is_cut(void **state)
{
	(void)state;
	struct server server;
	struct reader reader;
	server_start(&server, 0);
	reader_start(&reader, server.port);
	assert_int_equal(reader.gnss->state, GNSS_AWAY);
	reader_meets(&reader, &server);
	assert_int_equal(reader.gnss->state, GNSS_WAITING);
	for (size_t i = 0; i < sizeof(tpv) - 1; i += 7) {
		size_t size = sizeof(tpv) - 1 - i < 7 ? sizeof(tpv) - 1 - i : 7;
		server_say(&server, tpv + i, size);
		reader_run(&reader, 0.02);
	}
	assert_int_equal(reader.fixes, 0);
	server_say(&server, "\r\n", 2);
	reader_run(&reader, 0.1);
	assert_int_equal(reader.fixes, 1);
	assert_int_equal(reader.gnss->state, GNSS_GOOD);
	assert_near(reader.fix.lat_deg, 46.2044, 1e-9);
	assert_true(reader.fix.time_ns > 0 && reader.fix.time_ns <= reader.now_ns);
	server_say(&server, "{\"class\":\"TPV\",\"mode\":1}\n", 25);
	reader_run(&reader, 0.1);
	assert_int_equal(reader.gnss->state, GNSS_NO_FIX);
	gnss_close(reader.gnss);
	server_stop(&server);
}

static void a_daemon_may_go_and_come_back(void **state)
{
	(void)state;
	struct server server;
	struct reader reader;
	server_start(&server, 0);
	unsigned port = server.port;
	server_stop(&server); /* nobody there at first */
	reader_start(&reader, port);
	reader_run(&reader, 3.0);
	assert_int_equal(reader.gnss->state, GNSS_AWAY);
	server_start(&server, port);
	reader_run(&reader, 8.1);
	reader_meets(&reader, &server);
	server_say(&server, tpv, sizeof(tpv) - 1);
	server_say(&server, "\n", 1);
	reader_run(&reader, 0.1);
	assert_int_equal(reader.fixes, 1);
	close(server.peer);
	reader_run(&reader, 0.1);
	assert_int_equal(reader.gnss->state, GNSS_AWAY);
	reader_run(&reader, 1.0);
	reader_meets(&reader, &server);
	reader_run(&reader, 11.0); /* and one that is silent is left */
	assert_true(reader.gnss->stats.connections >= 2);
	gnss_close(reader.gnss);
	server_stop(&server);
}

static void a_flood_and_nonsense_stop_nothing(void **state)
{
	(void)state;
	struct server server;
	struct reader reader;
	struct rng rng = rng_seed(8);
	static char noise[100000];
	server_start(&server, 0);
	reader_start(&reader, server.port);
	reader_meets(&reader, &server);
	for (size_t i = 0; i < sizeof(noise); i++)
		noise[i] = (char)(rng_u32(&rng) % 40 == 0 && i > 50000 ? '\n' : rng_u32(&rng) & 0xFF);
	server_say(&server, noise, sizeof(noise));
	server_say(&server, "\n", 1);
	server_say(&server, tpv, sizeof(tpv) - 1);
	server_say(&server, "\n", 1);
	reader_run(&reader, 1.0);
	assert_int_equal(reader.fixes, 1);
	assert_true(reader.gnss->stats.bad > 100);
	reader_run(&reader, 4.0);
	assert_int_equal(reader.gnss->state, GNSS_NO_FIX); /* its last word is old */
	gnss_close(reader.gnss);
	server_stop(&server);
}

/* --- a log --- */

static void a_log_replays_by_its_own_times(void **state)
{
	(void)state;
	char path[] = "/tmp/blvd_gnss_XXXXXX";
	int fd = mkstemp(path);
	FILE *file = fdopen(fd, "w");
	fputs("{\"class\":\"VERSION\"}\nnot json\n", file);
	for (int i = 0; i < 10; i++)
		fprintf(file,
			"{\"class\":\"TPV\",\"mode\":3,\"time\":\"2024-06-21T08:30:%02d.000Z\",\"lat\":46.2,\"lon\":6.%02d}\n", i,
			i);
	fclose(file);
	struct reader reader = { 0 };
	struct arena arena;
	arena_init(&arena, "gnss", reader.memory, sizeof(reader.memory));
	assert_int_equal(gnss_open(&reader.gnss, path, INT64_C(1718958600) * NS_PER_S, &arena), 0);
	reader_run(&reader, 0.5);
	assert_int_equal(reader.fixes, 0 + 1); /* the one at 08:30:00, which is time 0 */
	reader_run(&reader, 4.0);
	assert_int_equal(reader.fixes, 5);
	assert_near(reader.fix.lon_deg, 6.04, 1e-9);
	assert_int_equal(reader.fix.time_ns, 4 * NS_PER_S);
	reader_run(&reader, 20.0);
	assert_int_equal(reader.fixes, 10);
	assert_int_equal(reader.gnss->state, GNSS_ENDED);
	assert_int_equal(reader.gnss->stats.bad, 1);
	gnss_close(reader.gnss);
	unlink(path);
	assert_int_equal(gnss_open(&reader.gnss, path, 0, &arena), -ENOENT);
	assert_int_equal(gnss_open(&reader.gnss, "gpsd:no host here:1", 0, &arena), -EHOSTUNREACH);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(a_report_is_read),
		cmocka_unit_test(lines_are_what_they_are),
		cmocka_unit_test(what_is_not_said_is_unknown),
		cmocka_unit_test(damaged_lines_never_give_a_wrong_number),
		cmocka_unit_test(a_daemon_is_heard_line_by_line_however_it_is_cut),
		cmocka_unit_test(a_daemon_may_go_and_come_back),
		cmocka_unit_test(a_flood_and_nonsense_stop_nothing),
		cmocka_unit_test(a_log_replays_by_its_own_times),
	};
	return cmocka_run_group_tests(tests, NULL, NULL);
}
