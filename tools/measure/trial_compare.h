/* One frame of a representation against `full`: picture, holes, displacement. About 2 s of CPU time at 1280 x 720. */
#ifndef BLVD_TOOLS_MEASURE_TRIAL_COMPARE_H
#define BLVD_TOOLS_MEASURE_TRIAL_COMPARE_H

#include "tools/measure/displacement.h"
#include "tools/measure/entrant.h"
#include "tools/measure/trial_row.h"

/* What `full` shows of a frame; see displacement.h and holes.h. */
struct trial_reference {
	struct truth_image image; /* of `truth` */
	struct truth_pixel *truth;
	uint8_t *open;
	struct displacement_depth *depths;
	float *map; /* of displacements: of the entrant compared last */
};

/* Of a frame that `full` has drawn. To be finished in any case. Returns 0 or -EIO. */
int trial_reference(const struct replay_frame *frame, struct entrant *full, struct trial_reference *out);
void trial_reference_finish(struct trial_reference *reference);

/* Of a representation that has drawn the same frame. Fills in the row's compared part. `map` NULL or the path of a PNG:
 * what is far is green where it is displaced by no more than 1 px, yellow by more, red where it is not found; what is
 * near is dark. Returns 0 or -EIO. */
int trial_compare(const struct pkg *pkg, const struct replay_frame *frame, const struct entrant *full,
	const struct trial_reference *reference, struct entrant *shown, struct trial_row *row, const char *map);

/* Writes NAME-NUMBER.png of a representation, and unless it is `full`, NAME-NUMBER-difference.png. Returns 0 or -EIO.
 */
int trial_write_pictures(const char *folder, uint32_t number, const struct entrant *full, const struct entrant *shown);

#endif
