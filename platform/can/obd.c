#include "platform/can/obd.h"

#include <assert.h>

#define NS_PER_S INT64_C(1000000000)
#define ANSWER_NS (NS_PER_S / 5) /* a unit has 50 ms; gateways take longer */
#define BACKOFF_MIN_NS NS_PER_S
#define BACKOFF_MAX_NS (30 * NS_PER_S)
#define TESTER_NS (5 * NS_PER_S)   /* another tester is gone after so long */
#define REFUSED_NS (60 * NS_PER_S) /* everything was refused: ask again after so long */
#define MISSES_MAX 3

#define SERVICE 0x01
#define ANSWER_BIT 0x40
#define NEGATIVE 0x7F

void obd_init(struct obd *obd, const struct obd_config *config, int64_t now_ns)
{
	*obd = (struct obd){ .config = *config, .asked_ns = INT64_MIN, .next_ns = now_ns };
	if (obd->config.pid_count > OBD_PIDS_MAX)
		obd->config.pid_count = OBD_PIDS_MAX;
	assert(config->pid_count == 0 || config->rate_hz > 0.0);
	obd->extended = config->addressing == OBD_ADDRESSING_29;
}

/* Nobody has answered the open question. */
static void note_silence(struct obd *obd, int64_t now_ns)
{
	obd->asked_ns = INT64_MIN;
	if (++obd->misses < MISSES_MAX && !obd->backoff_ns)
		return;
	obd->has_unit = false;
	if (!obd->met && obd->config.addressing == OBD_ADDRESSING_AUTO)
		obd->extended = !obd->extended;
	obd->backoff_ns = obd->backoff_ns ? 2 * obd->backoff_ns : BACKOFF_MIN_NS;
	if (obd->backoff_ns > BACKOFF_MAX_NS)
		obd->backoff_ns = BACKOFF_MAX_NS;
	obd->next_ns = now_ns + obd->backoff_ns;
}

/* Index of the PID whose turn it is; config.pid_count when all were refused. */
static unsigned choose(const struct obd *obd)
{
	unsigned count = obd->config.pid_count, others = count - 1;
	unsigned wanted = others && obd->turn % 5 == 4 ? 1 + obd->turn / 5 % others : 0;
	for (unsigned i = 0; i < count; i++) {
		unsigned at = (wanted + i) % count;
		if (!(obd->refused >> at & 1))
			return at;
	}
	return count;
}

bool obd_ask(struct obd *obd, int64_t now_ns, struct can_frame_rx *question)
{
	if (obd->asked_ns != INT64_MIN && now_ns - obd->asked_ns >= ANSWER_NS)
		note_silence(obd, now_ns);
	if (obd->config.pid_count == 0 || obd->asked_ns != INT64_MIN || now_ns < obd->next_ns)
		return false;
	unsigned at = choose(obd);
	if (at == obd->config.pid_count) {
		obd->refused = 0;
		obd->next_ns = now_ns + REFUSED_NS;
		return false;
	}
	obd->turn++;
	obd->questions++;
	obd->pid = obd->config.pids[at];
	obd->asked_ns = now_ns;
	obd->next_ns = now_ns + (int64_t)((double)NS_PER_S / obd->config.rate_hz);
	*question = (struct can_frame_rx){
		.time_ns = now_ns,
		.id = obd->extended ? 0x18DB33F1 : 0x7DF,
		.bus = obd->config.bus,
		.flags = obd->extended ? CAN_FRAME_EXT : 0,
		.len = 8,
		.data = { 2, SERVICE, obd->pid, 0x55, 0x55, 0x55, 0x55, 0x55 },
	};
	return true;
}

void obd_failed(struct obd *obd, int64_t now_ns)
{
	obd->misses = MISSES_MAX;
	note_silence(obd, now_ns);
}

enum kind { NOT_OBD, QUESTION, ANSWER };

static enum kind kind_of(const struct can_frame_rx *frame)
{
	if (frame->flags & (CAN_FRAME_REMOTE | CAN_FRAME_ERROR | CAN_FRAME_FD))
		return NOT_OBD;
	if (frame->flags & CAN_FRAME_EXT) {
		uint32_t to = frame->id & 0x1FFFFF00;
		if (frame->id == 0x18DB33F1 || (to >= 0x18DA0000 && to < 0x18DB0000 && (frame->id & 0xFF) == 0xF1))
			return QUESTION;
		return to == 0x18DAF100 ? ANSWER : NOT_OBD;
	}
	if (frame->id == 0x7DF || (frame->id >= 0x7E0 && frame->id <= 0x7E7))
		return QUESTION;
	return frame->id >= 0x7E8 && frame->id <= 0x7EF ? ANSWER : NOT_OBD;
}

static unsigned index_of(const struct obd *obd, uint8_t pid)
{
	for (unsigned i = 0; i < obd->config.pid_count; i++)
		if (obd->config.pids[i] == pid)
			return i;
	return OBD_PIDS_MAX;
}

/* Somebody is there, whatever was said. */
static void note_answer(struct obd *obd)
{
	obd->asked_ns = INT64_MIN;
	obd->misses = 0;
	obd->backoff_ns = 0;
	obd->met = true;
}

static bool take_answer(struct obd *obd, struct can_frame_rx *frame)
{
	const uint8_t *data = frame->data;
	unsigned length = data[0]; /* a single frame: the high half is 0 */
	bool asked = obd->asked_ns != INT64_MIN, extended = frame->flags & CAN_FRAME_EXT;
	if (length < 2 || length > 7 || frame->len < length + 1)
		return false;
	if (asked && extended == obd->extended && length >= 3 && data[1] == NEGATIVE && data[2] == SERVICE) {
		unsigned at = index_of(obd, obd->pid);
		note_answer(obd);
		if (at < OBD_PIDS_MAX)
			obd->refused |= (uint8_t)(1u << at);
		return false;
	}
	if (data[1] != (SERVICE | ANSWER_BIT) || length < 3)
		return false;
	if (obd->has_unit && frame->id != obd->unit)
		return false; /* and no answer: should the one that is listened to fall silent, another is looked for */
	if (asked && extended == obd->extended && data[2] == obd->pid) {
		obd->unit = frame->id;
		obd->has_unit = true;
		obd->answers++;
		note_answer(obd);
	}
	frame->id = OBD_ANSWER_ID;
	frame->flags &= (uint8_t)~CAN_FRAME_EXT;
	return true;
}

bool obd_take(struct obd *obd, struct can_frame_rx *frame)
{
	enum kind kind = frame->bus == obd->config.bus ? kind_of(frame) : NOT_OBD;
	if (kind == NOT_OBD)
		return true;
	if (kind == ANSWER)
		return take_answer(obd, frame);
	if (obd->next_ns < frame->time_ns + TESTER_NS) /* what we send is not shown to us: this is somebody else */
		obd->next_ns = frame->time_ns + TESTER_NS;
	return false;
}
