/* DBC text -> linked messages and signals in an arena. One pass over the text, init time only; statements that name
 * signals find them through a hash of identifiers, so the cost is linear for all but hostile files. */
#include "platform/can/dbc.h"

#include <ctype.h>
#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BUCKETS 1024u
#define SIGNALS_PER_MESSAGE_MAX 1024u
#define NUMBER_SIZE 64
#define ID_EXTENDED UINT32_C(0x80000000)
#define ID_NO_FRAME UINT32_C(0xC0000000) /* VECTOR__INDEPENDENT_SIG_MSG */
#define MUX_DEPTH 8                      /* as in dbc_bits.c */

struct reader {
	const char *at, *end;
	unsigned line;
	struct arena *arena;
	struct dbc *dbc;
	struct dbc_note *error;
	int status;                    /* 0, or what dbc_parse returns */
	struct dbc_message *message;   /* being filled */
	struct dbc_message **messages; /* where the next one is linked */
	struct dbc_signal **signals;
};

/* A piece of the text. */
struct word {
	const char *at;
	size_t length;
};

__attribute__((format(printf, 3, 0))) static void note(
	struct dbc_note *to, unsigned line, const char *format, va_list args)
{
	to->line = line;
	vsnprintf(to->text, sizeof(to->text), format, args);
}

/* Always false, so that a parser can `return fail(...)`. The first failure stays. */
__attribute__((format(printf, 2, 3))) static bool fail(struct reader *in, const char *format, ...)
{
	if (in->status)
		return false;
	va_list args;
	va_start(args, format);
	note(in->error, in->line, format, args);
	va_end(args);
	in->status = -EINVAL;
	return false;
}

__attribute__((format(printf, 2, 3))) static void warn(struct reader *in, const char *format, ...)
{
	if (in->dbc->warnings++)
		return;
	va_list args;
	va_start(args, format);
	note(&in->dbc->first_warning, in->line, format, args);
	va_end(args);
}

static void *take_memory(struct reader *in, size_t size)
{
	void *memory = arena_alloc(in->arena, size, _Alignof(max_align_t));
	if (!memory && !in->status) {
		fail(in, "the definitions do not fit in the memory set aside for them (%zu bytes)", in->arena->size);
		in->status = -ENOMEM;
	}
	return memory;
}

static const char *keep(struct reader *in, struct word word)
{
	char *copy = arena_alloc(in->arena, word.length + 1, 1);
	if (!copy)
		return take_memory(in, SIZE_MAX / 2); /* reports */
	return memcpy(copy, word.at, word.length);
}

static void skip_blanks(struct reader *in)
{
	while (in->at < in->end && (*in->at == ' ' || *in->at == '\t' || *in->at == '\r'))
		in->at++;
}

static void skip_space(struct reader *in)
{
	for (; in->at < in->end && isspace((unsigned char)*in->at); in->at++)
		if (*in->at == '\n')
			in->line++;
}

static void skip_line(struct reader *in)
{
	while (in->at < in->end && *in->at != '\n')
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

static struct word take_word(struct reader *in)
{
	skip_blanks(in);
	struct word word = { in->at, 0 };
	while (in->at < in->end && (isalnum((unsigned char)*in->at) || *in->at == '_'))
		in->at++;
	word.length = (size_t)(in->at - word.at);
	return word;
}

static bool word_is(struct word word, const char *text)
{
	return word.length == strlen(text) && !memcmp(word.at, text, word.length);
}

/* A name, kept in the arena. */
static const char *take_name(struct reader *in, const char *of)
{
	struct word word = take_word(in);
	if (!word.length || word.length > DBC_NAME_MAX) {
		fail(in, "%s has no name of 1 to %d letters, digits or _", of, DBC_NAME_MAX);
		return NULL;
	}
	return keep(in, word);
}

static bool take_number(struct reader *in, double *out)
{
	char text[NUMBER_SIZE];
	size_t n = 0;
	skip_blanks(in);
	while (in->at < in->end && n + 1 < sizeof(text) && *in->at && strchr("0123456789+-.eE", *in->at))
		text[n++] = *in->at++;
	text[n] = 0;
	char *stop = text;
	*out = strtod(text, &stop);
	return n && !*stop && isfinite(*out);
}

static bool take_unsigned(struct reader *in, uint64_t max, uint64_t *out)
{
	skip_blanks(in);
	const char *start = in->at;
	uint64_t value = 0;
	for (; in->at < in->end && isdigit((unsigned char)*in->at); in->at++) {
		if (value > (max - (uint64_t)(*in->at - '0')) / 10)
			return false;
		value = value * 10 + (uint64_t)(*in->at - '0');
	}
	*out = value;
	return in->at > start && value <= max;
}

/* Raw values are whole numbers, but some generators write 1.0. */
static bool take_raw(struct reader *in, int64_t *out)
{
	const char *start = in->at;
	uint64_t magnitude;
	bool negative = take(in, '-');
	if (take_unsigned(in, negative ? (uint64_t)INT64_MAX : UINT64_MAX, &magnitude) &&
		(in->at == in->end || !strchr(".eE", *in->at))) {
		*out = negative ? -(int64_t)magnitude : (int64_t)magnitude;
		return true;
	}
	double number;
	in->at = start;
	if (!take_number(in, &number) || fabs(number) >= 9.2e18)
		return false;
	*out = (int64_t)number;
	return true;
}

/* Text in quotes; may run over lines. A backslash keeps a quote from ending it. */
static bool take_text(struct reader *in, struct word *out)
{
	unsigned start_line = in->line;
	*out = (struct word){ in->at, 0 };
	if (!take(in, '"'))
		return fail(in, "text in quotes expected");
	out->at = in->at;
	for (; in->at < in->end && *in->at != '"'; in->at++) {
		if (*in->at == '\n')
			in->line++;
		if (*in->at == '\\' && in->end - in->at > 1 && in->at[1] == '"')
			in->at++;
	}
	out->length = (size_t)(in->at - out->at);
	if (in->at == in->end) {
		in->line = start_line;
		return fail(in, "text in quotes is never closed");
	}
	in->at++;
	return true;
}

static bool skip_statement(struct reader *in, struct word keyword)
{
	unsigned start_line = in->line;
	struct word text;
	while (in->at < in->end && *in->at != ';') {
		if (*in->at == '"') {
			if (!take_text(in, &text))
				return false;
			continue;
		}
		if (*in->at == '\n')
			in->line++;
		in->at++;
	}
	if (in->at < in->end) {
		in->at++;
		return true;
	}
	in->line = start_line;
	return fail(in, "'%.*s' is never closed by a ';'", (int)(keyword.length < 40 ? keyword.length : 40), keyword.at);
}

static unsigned bucket_of(uint32_t id, bool extended)
{
	return (id * 2654435761u ^ (extended ? 0x155u : 0u)) >> 7 & (BUCKETS - 1);
}

const struct dbc_message *dbc_find_id(const struct dbc *dbc, uint32_t id, bool extended)
{
	struct dbc_message *message = dbc->buckets ? dbc->buckets[bucket_of(id, extended)] : NULL;
	while (message && (message->id != id || message->extended != extended))
		message = message->next_in_bucket;
	return message;
}

static struct dbc_message *find_file_id(struct reader *in, uint64_t file_id)
{
	bool extended = file_id & ID_EXTENDED;
	return (struct dbc_message *)(uintptr_t)dbc_find_id(
		in->dbc, (uint32_t)file_id & (extended ? CAN_FRAME_EXT_MASK : UINT32_MAX), extended);
}

static struct dbc_signal *find_signal_word(const struct dbc_message *message, struct word name)
{
	struct dbc_signal *signal = message->signals;
	while (signal && !word_is(name, signal->name))
		signal = signal->next;
	return signal;
}

static bool parse_message(struct reader *in)
{
	uint64_t id, length;
	if (!take_unsigned(in, UINT32_MAX, &id))
		return fail(in, "BO_ has no message number");
	bool pseudo = id == ID_NO_FRAME, extended = id & ID_EXTENDED;
	if (!pseudo && (extended ? (id & ~ID_EXTENDED) > CAN_FRAME_EXT_MASK : id > CAN_FRAME_STD_MASK))
		return fail(in, "message number %llu is no CAN identifier", (unsigned long long)id);
	struct dbc_message *message = take_memory(in, sizeof(*message));
	if (!message)
		return false;
	message->name = take_name(in, "BO_");
	if (!message->name)
		return false;
	if (!take(in, ':') || !take_unsigned(in, UINT16_MAX, &length))
		return fail(in, "message '%.40s' has no ': length'", message->name);
	skip_line(in); /* the transmitter */
	message->id = (uint32_t)id & (extended ? CAN_FRAME_EXT_MASK : UINT32_MAX);
	message->extended = extended;
	message->pseudo = pseudo;
	message->length = (uint16_t)length;
	message->line = in->line;
	const struct dbc_message *twin = pseudo ? NULL : dbc_find_id(in->dbc, message->id, extended);
	if (twin)
		warn(in, "message '%.40s' has the number of '%.40s' in line %u", message->name, twin->name, twin->line);
	struct dbc_message **bucket = &in->dbc->buckets[bucket_of(message->id, extended)];
	while (*bucket) /* at the end: the first of two with one number is the one found */
		bucket = &(*bucket)->next_in_bucket;
	*bucket = message;
	*in->messages = message;
	in->messages = &message->next;
	in->message = message;
	in->signals = &message->signals;
	in->dbc->message_count++;
	return true;
}

/* "M", "m3" or "m3M" between the name and the colon. */
static bool parse_mux(struct reader *in, struct dbc_signal *signal)
{
	struct word word = take_word(in);
	const char *at = word.at, *end = word.at + word.length;
	if (at < end && *at == 'm') {
		struct dbc_mux_range *range = take_memory(in, sizeof(*range));
		if (!range)
			return false;
		const char *digits = ++at;
		for (; at < end && isdigit((unsigned char)*at) && at - digits < 10; at++)
			range->low = range->low * 10 + (uint64_t)(*at - '0');
		if (at == digits)
			return fail(in, "signal '%.40s': no number after the multiplexer's 'm'", signal->name);
		range->high = range->low;
		signal->ranges = range;
		signal->is_multiplexed = true;
	}
	if (at < end && *at == 'M') {
		signal->is_selector = true;
		at++;
	}
	return at == end || fail(in, "signal '%.40s': '%.*s' is no multiplexer", signal->name,
							(int)(word.length < 40 ? word.length : 40), word.at);
}

/* "start|length@order sign" */
static bool parse_layout(struct reader *in, struct dbc_signal *signal)
{
	uint64_t start, length;
	bool form =
		take_unsigned(in, 0xFFFF, &start) && take(in, '|') && take_unsigned(in, 0xFFFF, &length) && take(in, '@');
	skip_blanks(in);
	if (!form || in->end - in->at < 2 || (in->at[0] != '0' && in->at[0] != '1') ||
		(in->at[1] != '+' && in->at[1] != '-'))
		return fail(in, "signal '%.40s': 'start|length@order' and sign expected", signal->name);
	if (length < 1 || length > 64)
		return fail(in, "signal '%.40s' is %llu bits long, not 1 to 64", signal->name, (unsigned long long)length);
	signal->start = (uint16_t)start;
	signal->length = (uint8_t)length;
	signal->big_endian = in->at[0] == '0';
	signal->type = in->at[1] == '-' ? DBC_SIGNED : DBC_UNSIGNED;
	in->at += 2;
	return true;
}

static bool parse_scaling(struct reader *in, struct dbc_signal *signal)
{
	if (!take(in, '(') || !take_number(in, &signal->scale) || !take(in, ',') || !take_number(in, &signal->offset) ||
		!take(in, ')'))
		return fail(in, "signal '%.40s': '(scale,offset)' expected", signal->name);
	if (signal->scale == 0.0)
		return fail(in, "signal '%.40s' has scale 0", signal->name);
	if (!take(in, '[') || !take_number(in, &signal->min) || !take(in, '|') || !take_number(in, &signal->max) ||
		!take(in, ']'))
		return fail(in, "signal '%.40s': '[min|max]' expected", signal->name);
	return true;
}

static void check_layout(struct reader *in, const struct dbc_signal *signal)
{
	unsigned first = signal->big_endian ? signal->start / 8u * 8u + (7u - signal->start % 8u) : signal->start;
	if (!in->message->pseudo && first + signal->length > in->message->length * 8u)
		warn(in, "signal '%.40s' does not fit in message '%.40s'", signal->name, in->message->name);
}

static bool parse_signal(struct reader *in)
{
	struct dbc_message *message = in->message;
	if (!message)
		return fail(in, "SG_ before any BO_");
	if (message->signal_count == SIGNALS_PER_MESSAGE_MAX)
		return fail(in, "message '%.40s' has more than %u signals", message->name, SIGNALS_PER_MESSAGE_MAX);
	struct dbc_signal *signal = take_memory(in, sizeof(*signal));
	if (!signal)
		return false;
	signal->message = message;
	signal->line = in->line;
	signal->name = take_name(in, "SG_");
	if (!signal->name || !parse_mux(in, signal))
		return false;
	if (!take(in, ':'))
		return fail(in, "signal '%.40s': ':' expected", signal->name);
	struct word unit;
	if (!parse_layout(in, signal) || !parse_scaling(in, signal) || !take_text(in, &unit))
		return false;
	signal->unit = keep(in, unit);
	skip_line(in); /* the receivers */
	check_layout(in, signal);
	if (find_signal_word(message, (struct word){ signal->name, strlen(signal->name) }))
		warn(in, "message '%.40s' has two signals '%.40s'", message->name, signal->name);
	*in->signals = signal;
	in->signals = &signal->next;
	message->signal_count++;
	in->dbc->signal_count++;
	return signal->unit != NULL;
}

/* "number name", as VAL_, SIG_VALTYPE_ and SG_MUL_VAL_ begin. NULL when the statement is about nothing known, with a
 * warning, or on failure. */
static struct dbc_signal *take_signal_reference(struct reader *in, const char *statement)
{
	uint64_t id;
	if (!take_unsigned(in, UINT32_MAX, &id)) {
		fail(in, "%s: message number expected", statement);
		return NULL;
	}
	struct word name = take_word(in);
	if (!name.length) {
		fail(in, "%s: signal name expected", statement);
		return NULL;
	}
	struct dbc_message *message = find_file_id(in, id);
	struct dbc_signal *signal = message ? find_signal_word(message, name) : NULL;
	if (!signal)
		warn(in, "%s names signal '%.*s' of message %llu, which is not defined", statement,
			(int)(name.length < 40 ? name.length : 40), name.at, (unsigned long long)id);
	return signal;
}

static bool parse_values(struct reader *in, struct word keyword)
{
	skip_blanks(in);
	if (in->at == in->end || !isdigit((unsigned char)*in->at))
		return skip_statement(in, keyword); /* an environment variable's table */
	struct dbc_signal *signal = take_signal_reference(in, "VAL_");
	if (!signal)
		return !in->status && skip_statement(in, keyword);
	const struct dbc_value **link = &signal->values;
	while (*link)
		link = (const struct dbc_value **)(uintptr_t) & (*link)->next;
	for (;;) {
		skip_space(in);
		if (take(in, ';'))
			return true;
		struct dbc_value *value = take_memory(in, sizeof(*value));
		struct word text;
		if (!value)
			return false;
		if (!take_raw(in, &value->raw))
			return fail(in, "VAL_ of '%.40s': a number, text or ';' expected", signal->name);
		skip_space(in);
		if (!take_text(in, &text))
			return false;
		value->text = keep(in, text);
		if (!value->text)
			return false;
		*link = value;
		link = &value->next;
	}
}

static bool parse_value_type(struct reader *in, struct word keyword)
{
	struct dbc_signal *signal = take_signal_reference(in, "SIG_VALTYPE_");
	uint64_t type;
	if (!signal)
		return !in->status && skip_statement(in, keyword);
	take(in, ':'); /* some write it, some do not */
	if (!take_unsigned(in, 3, &type))
		return fail(in, "SIG_VALTYPE_ of '%.40s': 0 to 3 expected", signal->name);
	if ((type == 1 && signal->length != 32) || (type == 2 && signal->length != 64))
		return fail(in, "signal '%.40s' of %d bits cannot be a %s", signal->name, signal->length,
			type == 1 ? "float" : "double");
	if (type == 1)
		signal->type = DBC_FLOAT;
	if (type == 2)
		signal->type = DBC_DOUBLE;
	return skip_statement(in, keyword);
}

static bool parse_mux_ranges(struct reader *in, struct word keyword)
{
	struct dbc_signal *signal = take_signal_reference(in, "SG_MUL_VAL_");
	if (!signal)
		return !in->status && skip_statement(in, keyword);
	struct word name = take_word(in);
	signal->selector = find_signal_word(signal->message, name);
	if (!signal->selector)
		warn(in, "SG_MUL_VAL_ of '%.40s' names a selector that is not defined", signal->name);
	signal->is_multiplexed = true;
	signal->ranges = NULL;
	do {
		struct dbc_mux_range *range = take_memory(in, sizeof(*range));
		if (!range)
			return false;
		if (!take_unsigned(in, UINT64_MAX, &range->low) || !take(in, '-') ||
			!take_unsigned(in, UINT64_MAX, &range->high))
			return fail(in, "SG_MUL_VAL_ of '%.40s': 'low-high' expected", signal->name);
		range->next = signal->ranges;
		signal->ranges = range;
	} while (take(in, ','));
	return skip_statement(in, keyword);
}

/* BA_ "GenMsgCycleTime" BO_ number ms; other attributes say nothing to us. */
static bool parse_attribute(struct reader *in, struct word keyword)
{
	struct word name;
	uint64_t id;
	double ms;
	if (!take_text(in, &name))
		return false;
	if (word_is(name, "GenMsgCycleTime") && word_is(take_word(in), "BO_") && take_unsigned(in, UINT32_MAX, &id) &&
		take_number(in, &ms) && ms >= 0.0 && ms < 1e9) {
		struct dbc_message *message = find_file_id(in, id);
		if (message)
			message->cycle_ms = (uint32_t)ms;
	}
	return skip_statement(in, keyword);
}

/* The list of statement names: lines of one word each, up to the first that is not. */
static void skip_new_symbols(struct reader *in)
{
	skip_line(in);
	for (;;) {
		struct reader ahead = *in;
		skip_space(&ahead);
		take_word(&ahead);
		skip_blanks(&ahead);
		if (ahead.at == ahead.end || *ahead.at != '\n')
			return;
		*in = ahead;
	}
}

static bool ends_with_semicolon(struct word keyword)
{
	static const char *const words[] = { "CM_", "BA_DEF_", "BA_DEF_DEF_", "BA_DEF_REL_", "BA_REL_", "BA_DEF_DEF_REL_",
		"VAL_TABLE_", "SIG_GROUP_", "BO_TX_BU_", "EV_", "EV_DATA_", "ENVVAR_DATA_", "SGTYPE_", "SIG_TYPE_REF_",
		"BA_DEF_SGTYPE_", "BA_SGTYPE_", "SGTYPE_VAL_", "SIGTYPE_VALTYPE_", "CAT_DEF_", "CAT_" };
	for (size_t i = 0; i < sizeof(words) / sizeof(*words); i++)
		if (word_is(keyword, words[i]))
			return true;
	return false;
}

static bool parse_statement(struct reader *in)
{
	struct word keyword = take_word(in);
	if (word_is(keyword, "SG_"))
		return parse_signal(in);
	in->message = word_is(keyword, "BO_") ? in->message : NULL; /* a signal belongs to the message right above it */
	if (word_is(keyword, "BO_"))
		return parse_message(in);
	if (word_is(keyword, "VAL_"))
		return parse_values(in, keyword);
	if (word_is(keyword, "SIG_VALTYPE_"))
		return parse_value_type(in, keyword);
	if (word_is(keyword, "SG_MUL_VAL_"))
		return parse_mux_ranges(in, keyword);
	if (word_is(keyword, "BA_"))
		return parse_attribute(in, keyword);
	if (word_is(keyword, "NS_"))
		skip_new_symbols(in);
	else if (ends_with_semicolon(keyword))
		return skip_statement(in, keyword);
	else
		skip_line(in);
	return true;
}

static bool chain_too_long(const struct dbc_signal *signal)
{
	for (int depth = 0; signal && signal->is_multiplexed; depth++, signal = signal->selector)
		if (depth == MUX_DEPTH)
			return true;
	return false;
}

/* A signal that has only "m3" belongs to the message's one plain selector. */
static void link_selectors(struct reader *in, const struct dbc_message *message)
{
	const struct dbc_signal *main_selector = NULL;
	for (const struct dbc_signal *signal = message->signals; signal && !main_selector; signal = signal->next)
		if (signal->is_selector && !signal->is_multiplexed)
			main_selector = signal;
	for (struct dbc_signal *signal = message->signals; signal; signal = signal->next) {
		if (!signal->is_multiplexed)
			continue;
		if (!signal->selector)
			signal->selector = main_selector;
		in->line = signal->line;
		if (!signal->selector)
			warn(in, "signal '%.40s' is multiplexed, but message '%.40s' has no multiplexer", signal->name,
				message->name);
		else if (chain_too_long(signal))
			fail(in, "signal '%.40s': its multiplexers are nested too deep or in a circle", signal->name);
	}
}

static void parse_all(struct reader *in)
{
	const char *nul = memchr(in->at, 0, (size_t)(in->end - in->at));
	if (nul) {
		fail(in, "not a text file");
		return;
	}
	if (in->end - in->at >= 3 && !memcmp(in->at, "\xEF\xBB\xBF", 3))
		in->at += 3;
	for (skip_space(in); in->at < in->end && parse_statement(in); skip_space(in))
		;
	for (const struct dbc_message *message = in->dbc->messages; message && !in->status; message = message->next)
		link_selectors(in, message);
	in->line = 0;
	if (!in->dbc->message_count)
		fail(in, "no message (BO_) in it");
}

int dbc_parse(struct dbc *out, const char *text, size_t size, struct arena *arena, struct dbc_note *error)
{
	size_t mark = arena_mark(arena);
	*out = (struct dbc){ 0 };
	*error = (struct dbc_note){ 0 };
	struct reader in = { .at = text, .end = text + size, .line = 1, .arena = arena, .dbc = out, .error = error };
	in.messages = &out->messages;
	out->buckets = take_memory(&in, BUCKETS * sizeof(void *));
	if (out->buckets)
		parse_all(&in);
	if (in.status)
		arena_release(arena, mark);
	return in.status;
}

const struct dbc_message *dbc_find_message(const struct dbc *dbc, const char *name)
{
	const struct dbc_message *message = dbc->messages;
	while (message && strcmp(message->name, name) != 0)
		message = message->next;
	return message;
}

const struct dbc_signal *dbc_find_signal(const struct dbc *dbc, const char *message_name, const char *name)
{
	struct word word = { name, strlen(name) };
	for (const struct dbc_message *message = dbc->messages; message; message = message->next) {
		if (message_name && strcmp(message->name, message_name) != 0)
			continue;
		const struct dbc_signal *signal = find_signal_word(message, word);
		if (signal)
			return signal;
	}
	return NULL;
}
