/* The package of a tau: the city with a far field made for it, along one drive, with all that measuring wants. */
#ifndef BLVD_TOOLS_MEASURE_TAU_PACKAGE_H
#define BLVD_TOOLS_MEASURE_TAU_PACKAGE_H

/* The tau that a package's impostors were made for; 0 when it has none. < 0 when it cannot be opened, after logging one
 * line. */
double tau_package_tau(const char *package);

/* Makes `path` from the city unless it is there: visible sets, impostors and their truth, of what the drive needs.
 * `seconds` gets how long that took, then or now. A stopped bake goes on where it was. Returns 0 or -errno after
 * logging one line. */
int tau_package_make(const char *city, const char *log, double tau_px, const char *path, double *seconds);

#endif
