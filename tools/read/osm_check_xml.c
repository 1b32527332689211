/* Well-formedness by expat, for the line of the first fault. */
#include "tools/read/osm_check.h"

#include <errno.h>
#include <expat.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "platform/base/log.h"

#define CHUNK_BYTES 65536

struct root {
	bool seen, is_osm;
};

static void on_start(void *data, const XML_Char *name, const XML_Char **attributes)
{
	struct root *root = data;
	(void)attributes;
	if (!root->seen)
		root->is_osm = !strcmp(name, "osm") || !strcmp(name, "osmChange");
	root->seen = true;
}

static int check(XML_Parser parser, FILE *file, const char *name)
{
	struct root root = { 0 };
	XML_SetUserData(parser, &root);
	XML_SetStartElementHandler(parser, on_start);
	for (bool last = false; !last;) {
		void *buffer = XML_GetBuffer(parser, CHUNK_BYTES);
		if (!buffer)
			return -ENOMEM;
		size_t got = fread(buffer, 1, CHUNK_BYTES, file);
		last = got < CHUNK_BYTES;
		if (ferror(file)) {
			log_error("%s: %s", name, strerror(errno));
			return -EIO;
		}
		if (XML_ParseBuffer(parser, (int)got, last) != XML_STATUS_OK) {
			log_error("%s: line %lu: malformed XML: %s", name, (unsigned long)XML_GetCurrentLineNumber(parser),
				XML_ErrorString(XML_GetErrorCode(parser)));
			return -EBADMSG;
		}
		if (root.seen && !root.is_osm) {
			log_error("%s: line 1: XML, but not OpenStreetMap data (no <osm> element)", name);
			return -EBADMSG;
		}
	}
	return 0;
}

int osm_check_xml(const char *path, const char *name)
{
	FILE *file = fopen(path, "rbe");
	if (!file) {
		log_error("%s: %s", name, strerror(errno));
		return -errno;
	}
	XML_Parser parser = XML_ParserCreate(NULL);
	int status = parser ? check(parser, file, name) : -ENOMEM;
	XML_ParserFree(parser);
	fclose(file);
	return status;
}
