/*
 * What a bake met: faults by kind, each found one either mended or dropped, and counts of what was read. Printed as a
 * table at the end and written by `--report FILE.json`. found == mended + dropped holds for every kind, and
 * read == used + dropped + ignored for every kind of element.
 */
#ifndef BLVD_TOOLS_CITY_REPORT_H
#define BLVD_TOOLS_CITY_REPORT_H

#include <stdint.h>
#include <stdio.h>

enum fault_kind {
	FAULT_MISSING_NODE,    /* a way names a node that the file does not hold */
	FAULT_MISSING_MEMBER,  /* a relation names a way that the file does not hold */
	FAULT_OPEN_RING,       /* an area whose ring does not close */
	FAULT_SELF_CROSSING,   /* a ring that crosses itself */
	FAULT_DUPLICATE_NODE,  /* the same point twice in a row */
	FAULT_DEGENERATE_RING, /* fewer than three points or no area */
	FAULT_DEGENERATE_WAY,  /* fewer than two points or no length */
	FAULT_BAD_NUMBER,      /* a tag whose value is no number, or out of range */
	FAULT_BAD_COLOUR,
	FAULT_MISSING_HEIGHT,       /* inferred */
	FAULT_HEIGHT_ORDER,         /* min_height >= height, roof higher than the building */
	FAULT_OVERLAPPING_BUILDING, /* the same footprint twice, or most of it */
	FAULT_PART_WITHOUT_OUTLINE, /* drawn as a building of its own */
	FAULT_PARTS_INCOMPLETE,     /* parts leave some of their outline's ground bare; the rest becomes a part */
	FAULT_STREET_THROUGH_BUILDING,
	FAULT_BUILDING_IN_STREET,    /* footprint reaches into the carriageway */
	FAULT_CROSSING_WITHOUT_NODE, /* streets of one layer cross without a shared node */
	FAULT_NEAR_MISS_NODE,        /* street ends closer than 0.5 m to another without touching */
	FAULT_DUPLICATE_EDGE,        /* the same street twice */
	FAULT_UNCONNECTED_STREET,    /* not connected with the largest component */
	FAULT_RESTRICTION,           /* names streets that do not meet, or a kind that is not known */
	FAULT_BRIDGE_PROFILE,        /* a deck too low over what it crosses; lifted */
	FAULT_TERRAIN_VOID,
	FAULT_BAD_GEOMETRY, /* a polygon operation failed; the feature is drawn simpler or dropped */
	FAULT_BAD_STRING,   /* text that is not UTF-8, or has control characters */
	FAULT_KIND_COUNT,
};

enum fault_outcome { FAULT_MENDED, FAULT_DROPPED };

enum element_kind { ELEMENT_NODE, ELEMENT_WAY, ELEMENT_RELATION, ELEMENT_FEATURE, ELEMENT_KIND_COUNT };
enum element_fate {
	ELEMENT_USED,
	ELEMENT_FAULTY,  /* dropped for a fault counted above */
	ELEMENT_IGNORED, /* nothing in it that is drawn */
	ELEMENT_FATE_COUNT,
};

struct report {
	uint64_t faults[FAULT_KIND_COUNT][2]; /* by enum fault_outcome */
	int64_t first_id[FAULT_KIND_COUNT];   /* of the first feature met, for looking it up */
	uint64_t elements[ELEMENT_KIND_COUNT][ELEMENT_FATE_COUNT];
	uint64_t heights[8]; /* by enum height_source */
	uint64_t counts[16]; /* by enum report_count */
	double seconds[16];  /* by enum report_step */
};

enum report_count {
	COUNT_BUILDINGS,
	COUNT_PARTS,
	COUNT_WAYS,
	COUNT_DRIVABLE_WAYS,
	COUNT_TREES,
	COUNT_AREAS,
	COUNT_NODES,
	COUNT_EDGES,
	COUNT_FACES,
	COUNT_TRIANGLES,
	COUNT_CHUNKS,
	COUNT_RESTRICTIONS,
	COUNT_KINDS
};
enum report_step {
	STEP_READ,
	STEP_HEIGHTS,
	STEP_GRAPH,
	STEP_GROUND,
	STEP_BUILDINGS,
	STEP_TREES,
	STEP_TEXTURES,
	STEP_LIGHT,
	STEP_OCCLUDERS,
	STEP_TEXT,
	STEP_WRITE,
	STEP_KINDS
};

void report_fault(struct report *report, enum fault_kind kind, enum fault_outcome outcome, int64_t id);

/* A table for people. */
void report_print(const struct report *report, FILE *to);

/* Returns 0 or -errno. Written whole or not at all. */
int report_write_json(const struct report *report, const char *path);

#endif
