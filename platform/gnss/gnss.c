#include "platform/gnss/gnss.h"

#include <string.h>

int gnss_open(struct gnss **out, const char *spec, int64_t wall_offset_ns, struct arena *arena)
{
	struct gnss_config config = { .source = spec, .wall_offset_ns = wall_offset_ns };
	bool daemon = !strncmp(spec, "gpsd", 4) && (!spec[4] || spec[4] == ':');
	if (daemon)
		config.source = spec[4] ? spec + 5 : "";
	return (daemon ? &gnss_gpsd_ops : &gnss_log_ops)->open(&config, arena, out);
}

bool gnss_read(struct gnss *gnss, int64_t now_ns, struct gnss_fix *out)
{
	return gnss && gnss->ops->read(gnss, now_ns, out);
}

void gnss_close(struct gnss *gnss)
{
	if (gnss)
		gnss->ops->close(gnss);
}
