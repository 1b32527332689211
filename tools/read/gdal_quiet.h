/* GDAL set up for a toolbox: drivers registered, its messages kept for our own one line instead of printed. */
#ifndef BLVD_TOOLS_READ_GDAL_QUIET_H
#define BLVD_TOOLS_READ_GDAL_QUIET_H

/* Any number of times. */
void gdal_start(void);

/* GDAL's last message, or `otherwise`. Valid until GDAL's next call. */
const char *gdal_reason(const char *otherwise);

#endif
