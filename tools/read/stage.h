/* Input files made readable for libraries that go by the file's name: unpacked (.gz, .bz2) or under a name with the
 * ending that its content asks for. */
#ifndef BLVD_TOOLS_READ_STAGE_H
#define BLVD_TOOLS_READ_STAGE_H

#include <stdbool.h>
#include <stdint.h>

enum input_format { INPUT_OSM_XML, INPUT_OSM_PBF, INPUT_JSON };

struct staged {
	enum input_format format;
	char path[4096]; /* what to open: the file itself, or a temporary one */
	char folder[64]; /* temporary, removed by stage_close(); empty: none */
};

/* Returns 0, -errno or -EBADMSG after logging one line. */
int stage_open(struct staged *staged, const char *path);
void stage_close(struct staged *staged);

/* XML that claims to be UTF-8 and is not, or has characters that XML forbids, is replaced by a copy in which such bytes
 * are read as Latin-1 and such characters are blanks; `mended` is how many places there were. XML in other encodings is
 * left alone. Returns 0 or -errno after logging one line. */
int stage_mend_text(struct staged *staged, const char *name, uint64_t *mended);

#endif
