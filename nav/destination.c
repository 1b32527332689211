/* Collects the stops of the DESTINATION message; constant cost a frame. */
#include "nav/destination.h"

#include <string.h>

void destination_init(struct destination *destination, const struct dbc *dbc)
{
	*destination = (struct destination){ 0 };
	if (!dbc)
		return;
	*destination = (struct destination){
		.count_signal = dbc_find_signal(dbc, "DESTINATION", "StopCount"),
		.index_signal = dbc_find_signal(dbc, "DESTINATION", "StopIndex"),
		.lat_signal = dbc_find_signal(dbc, "DESTINATION", "Latitude"),
		.lon_signal = dbc_find_signal(dbc, "DESTINATION", "Longitude"),
	};
}

static bool same_list(const struct destination *destination)
{
	if (destination->heard_count != destination->stop_count)
		return false;
	for (uint32_t i = 0; i < destination->stop_count; i++)
		if (destination->heard[i].lat_deg != destination->stops[i].lat_deg ||
			destination->heard[i].lon_deg != destination->stops[i].lon_deg)
			return false;
	return true;
}

static bool adopt(struct destination *destination)
{
	if (same_list(destination))
		return false;
	memcpy(destination->stops, destination->heard, sizeof(destination->stops));
	destination->stop_count = destination->heard_count;
	return true;
}

bool destination_feed(struct destination *destination, const struct can_frame_rx *frame)
{
	int64_t count, index;
	double lat, lon;
	if (!destination->count_signal || !destination->index_signal || !destination->lat_signal ||
		!destination->lon_signal || !dbc_decode_raw(destination->count_signal, frame, &count) ||
		!dbc_decode_raw(destination->index_signal, frame, &index) ||
		!dbc_decode(destination->lat_signal, frame, &lat) || !dbc_decode(destination->lon_signal, frame, &lon))
		return false;
	if (count < 0 || count > DESTINATION_STOPS_MAX || index < 0 || (count && index >= count) ||
		!(lat >= -90.0 && lat <= 90.0) || !(lon >= -180.0 && lon <= 180.0))
		return false;
	/* A stop that differs from the one heard before belongs to a new list. */
	const struct geo_point *old = &destination->heard[index];
	bool known = destination->heard_mask & 1u << index;
	if (count != destination->heard_count || (known && (old->lat_deg != lat || old->lon_deg != lon)))
		destination->heard_mask = 0;
	destination->heard_count = (uint32_t)count;
	if (!count)
		return adopt(destination);
	destination->heard[index] = (struct geo_point){ lat, lon };
	destination->heard_mask |= 1u << index;
	return destination->heard_mask == (1u << count) - 1 && adopt(destination);
}
