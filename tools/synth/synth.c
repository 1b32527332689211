#include "tools/synth/synth.h"

/* Where nothing else is: hills by a lake. */
#define ORIGIN_LAT 47.05
#define ORIGIN_LON 8.15

void synth_make(struct synth *synth, const struct synth_options *options)
{
	*synth = (struct synth){ .options = *options };
	synth->city.frame = geo_frame_at((struct geo_point){ ORIGIN_LAT, ORIGIN_LON });
	synth->city.report = &synth->report;
	synth->doc = osm_doc_new(synth->city.frame);
	shaper_init(&synth->shaper, &synth->city.pool, &synth->report);
	plan_make(synth);
	streets_make(synth);
	blocks_make(synth);
	streets_write(synth);
	river_write(synth);
	railway_write(synth);
	outskirts_write(synth);
	landmarks_write(synth);
	for (size_t i = 0; i < synth->blocks.count; i++)
		houses_write(synth, &synth->blocks.items[i]);
}

void synth_finish(struct synth *synth)
{
	blocks_finish(synth);
	graph_data_finish(&synth->graph);
	ARRAY_FINISH(&synth->streets);
	ARRAY_FINISH(&synth->rail);
	ARRAY_FINISH(&synth->plan.s);
	ARRAY_FINISH(&synth->plan.t);
	shaper_finish(&synth->shaper);
	osm_doc_free(synth->doc);
	city_finish(&synth->city);
}
