/* Any line as a log line; what parses formats to a line that parses to the same frame. */
#include <stdlib.h>
#include <string.h>

#include "platform/can/candump.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	struct candump_record first, second;
	char line[CANDUMP_LINE_SIZE];
	if (candump_parse((const char *)data, size, &first))
		return 0;
	size_t length = candump_format(first.interface, &first.frame, line);
	if (length >= CANDUMP_LINE_SIZE || candump_parse(line, length - 1, &second))
		abort();
	if (memcmp(&first.frame, &second.frame, sizeof(first.frame)) != 0 || strcmp(first.interface, second.interface) != 0)
		abort();
	return 0;
}
