/*
 * Checks what impostors promise: renders each from random eyes of its view cell, headings within 45 degrees of the
 * street, and compares, for every texel in sight, where its middle is drawn with where its point is. So how finely the
 * screen is sampled is not counted. A texel's point is the mean of what it shows, which at a border lies up to half of
 * its diagonal from its middle. Texels that no capture has seen, where a surface goes on under what hides it, have no
 * point to compare; most of them lie behind nearer things. Needs a package baked with --truth.
 */
#ifndef BLVD_TOOLS_INSPECT_FAR_POSES_H
#define BLVD_TOOLS_INSPECT_FAR_POSES_H

#include "assets/pkg.h"

struct far_poses_result {
	uint64_t cells, pixels;
	uint64_t over_tau;   /* pixels displaced by more than the accuracy asked for */
	uint64_t over_error; /* ... by more than their cell's error_px, and half of the texel's diagonal */
	uint64_t made_up;    /* pixels beyond those, of texels that no capture has seen */
	double p50_px, p99_px, p999_px, max_px;
};

/* `poses` renders a cell, of a quarter of the pixels of a 1280 x 720 screen at 45 degrees; displacements are in pixels
 * of the whole screen. Returns 0, -ENODATA when no truth is stored, or -EBADMSG after logging one line. */
int far_poses_check(const struct pkg *pkg, unsigned poses, struct far_poses_result *out);

#endif
