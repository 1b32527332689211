/* Any text as signal definitions; what parses decodes and encodes frames of any content. */
#include <stdlib.h>
#include <string.h>

#include "platform/can/checksum.h"
#include "platform/can/dbc.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static void use(const struct dbc_signal *signal, struct can_frame_rx *frame)
{
	double value;
	int64_t raw;
	if (!dbc_decode(signal, frame, &value) || !dbc_decode_raw(signal, frame, &raw))
		return;
	dbc_value_text(signal, raw);
	dbc_encode(signal, value, frame);
	dbc_encode_raw(signal, raw, frame);
	can_checksum_good(CAN_CHECKSUM_CRC8, signal, frame);
	can_checksum_put(CAN_CHECKSUM_SUM, signal, frame);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	static _Alignas(64) uint8_t memory[1 << 20];
	struct arena arena;
	struct dbc dbc;
	struct dbc_note error;
	arena_init(&arena, "fuzz", memory, sizeof(memory));
	if (dbc_parse(&dbc, (const char *)data, size, &arena, &error)) {
		if (!error.text[0] || arena.used)
			abort();
		return 0;
	}
	for (const struct dbc_message *message = dbc.messages; message; message = message->next) {
		struct can_frame_rx frame;
		dbc_frame_init(message, &frame);
		memcpy(frame.data, data, size < frame.len ? size : frame.len);
		for (const struct dbc_signal *signal = message->signals; signal; signal = signal->next)
			use(signal, &frame);
	}
	return 0;
}
