#include "tools/read/text.h"

#include <stdint.h>
#include <string.h>

static bool is_tail(unsigned char byte)
{
	return (byte & 0xC0) == 0x80;
}

size_t text_sequence(const char *text)
{
	const unsigned char *b = (const unsigned char *)text;
	if (b[0] < 0x80)
		return b[0] ? 1 : 0;
	if (b[0] >= 0xC2 && b[0] <= 0xDF)
		return is_tail(b[1]) ? 2 : 0;
	if ((b[0] & 0xF0) == 0xE0) {
		bool overlong = b[0] == 0xE0 && b[1] < 0xA0, surrogate = b[0] == 0xED && b[1] >= 0xA0;
		return is_tail(b[1]) && is_tail(b[2]) && !overlong && !surrogate ? 3 : 0;
	}
	if (b[0] >= 0xF0 && b[0] <= 0xF4) {
		bool overlong = b[0] == 0xF0 && b[1] < 0x90, beyond = b[0] == 0xF4 && b[1] >= 0x90;
		return is_tail(b[1]) && is_tail(b[2]) && is_tail(b[3]) && !overlong && !beyond ? 4 : 0;
	}
	return 0;
}

static bool is_control(const char *text, size_t length)
{
	const unsigned char *b = (const unsigned char *)text;
	return (length == 1 && (b[0] < 0x20 || b[0] == 0x7F)) || (length == 2 && b[0] == 0xC2 && b[1] < 0xA0);
}

bool text_is_clean(const char *text)
{
	while (*text) {
		size_t length = text_sequence(text);
		if (!length || is_control(text, length))
			return false;
		text += length;
	}
	return true;
}

char *text_mend(struct pool *pool, const char *text)
{
	char *out = pool_alloc(pool, strlen(text) * 2 + 1), *at = out;
	while (*text) {
		size_t length = text_sequence(text);
		unsigned char byte = (unsigned char)*text;
		if (length && is_control(text, length)) {
			*at++ = ' ';
		} else if (length) {
			memcpy(at, text, length);
			at += length;
		} else if (byte < 0xA0) {
			*at++ = ' ';
			length = 1;
		} else {
			*at++ = (char)(0xC0 | byte >> 6);
			*at++ = (char)(0x80 | (byte & 0x3F));
			length = 1;
		}
		text += length;
	}
	*at = 0;
	return out;
}
