#include "tools/read/traffic_side.h"

/* Left-driving countries; coarse, but no city of a right-driving neighbour of any size lies in one. South, west, north,
 * east. */
static const double left_driving[][4] = {
	{ 49.85, -11.0, 61.0, 1.45 },    /* Britain, Ireland */
	{ 51.05, 1.4, 53.0, 1.8 },       /* Kent's and Norfolk's ends; Calais lies south of it */
	{ 49.1, -2.75, 49.75, -1.97 },   /* Channel Islands */
	{ 35.75, 14.1, 36.1, 14.6 },     /* Malta */
	{ 34.5, 32.2, 35.75, 34.65 },    /* Cyprus */
	{ 24.0, 122.8, 34.0, 131.8 },    /* Ryukyu, Kyushu */
	{ 32.5, 130.8, 45.55, 145.9 },   /* Japan's main islands */
	{ 34.05, 129.15, 34.75, 131.0 }, /* Tsushima */
	{ 22.13, 113.8, 22.56, 114.45 }, /* Hong Kong */
	{ 22.1, 113.52, 22.22, 113.61 }, /* Macau */
	{ -11.1, 95.0, 6.0, 141.1 },     /* Indonesia, Singapore, Borneo */
	{ 1.1, 99.6, 7.6, 119.4 },       /* Malaysia, Brunei */
	{ 5.6, 97.3, 14.6, 102.4 },      /* Thailand, south */
	{ 14.6, 98.6, 19.8, 101.0 },     /* Thailand, north-west */
	{ 14.6, 101.0, 17.4, 104.6 },    /* Thailand, north-east */
	{ 5.8, 79.4, 10.0, 82.0 },       /* Sri Lanka */
	{ 8.0, 68.0, 24.6, 88.0 },       /* India's peninsula */
	{ 24.6, 61.8, 31.5, 92.0 },      /* Pakistan, north India, Nepal, Bangladesh */
	{ 31.5, 70.0, 35.5, 79.0 },      /* Punjab, Kashmir */
	{ 20.6, 88.0, 28.0, 92.7 },      /* Bengal, Bhutan */
	{ 23.9, 92.0, 28.0, 96.5 },      /* Assam */
	{ -44.5, 112.5, -9.9, 180.0 },   /* Australia, New Zealand, Papua, Fiji */
	{ -48.0, 166.0, -34.0, 179.0 },  /* New Zealand's south */
	{ -35.0, 11.7, -17.0, 33.0 },    /* Namibia, South Africa, Botswana, Zimbabwe */
	{ -27.0, 30.0, -10.4, 41.0 },    /* Mozambique, Malawi */
	{ -18.0, 22.0, -12.5, 33.0 },    /* Zambia */
	{ -12.0, 30.9, 4.2, 41.9 },      /* Tanzania, Kenya, Uganda's east */
	{ -1.5, 29.9, 4.2, 33.0 },       /* Uganda */
	{ -20.6, 57.2, -19.9, 57.9 },    /* Mauritius */
	{ -10.3, 46.0, -3.5, 56.5 },     /* Seychelles */
	{ 17.6, -78.5, 18.6, -76.1 },    /* Jamaica */
	{ 20.8, -79.4, 27.3, -72.6 },    /* Bahamas */
	{ 10.0, -62.0, 11.4, -60.4 },    /* Trinidad, Tobago */
	{ 13.0, -59.7, 13.4, -59.4 },    /* Barbados */
	{ 1.1, -61.4, 8.6, -54.0 },      /* Guyana, Suriname */
	{ -52.5, -61.5, -51.0, -57.6 },  /* Falklands */
};

/* Right-driving places inside the rectangles above. */
static const double right_driving[][4] = {
	{ 33.0, 124.0, 34.0, 128.0 },   /* Jeju */
	{ 8.5, 102.4, 23.4, 110.0 },    /* Vietnam, Cambodia, Laos */
	{ 5.0, 116.9, 12.0, 127.0 },    /* Philippines' south */
	{ -5.0, 11.0, 2.0, 29.9 },      /* Congo */
	{ -4.5, 29.0, -1.0, 30.9 },     /* Rwanda, Burundi */
	{ 26.0, 61.0, 31.5, 61.9 },     /* Iran */
	{ 27.6, 85.0, 29.3, 86.0 },     /* Tibet's edge */
	{ -23.0, 163.0, -19.5, 168.5 }, /* New Caledonia */
};

static bool in_any(const double (*boxes)[4], size_t count, struct geo_point at)
{
	double lon = remainder(at.lon_deg, 360.0);
	for (size_t i = 0; i < count; i++)
		if (at.lat_deg >= boxes[i][0] && lon >= boxes[i][1] && at.lat_deg <= boxes[i][2] && lon <= boxes[i][3])
			return true;
	return false;
}

bool traffic_side_right_at(struct geo_point at)
{
	return !in_any(left_driving, sizeof(left_driving) / sizeof(*left_driving), at) ||
		   in_any(right_driving, sizeof(right_driving) / sizeof(*right_driving), at);
}

/* Positive: right, as many as that. Only whole roundabouts tell. */
static int roundabout_votes(const struct city *city)
{
	int votes = 0;
	for (size_t i = 0; i < city->ways.count; i++) {
		const struct way *way = &city->ways.items[i];
		if (!way->roundabout || !way->oneway || way->node_count < 4 ||
			way->nodes[0].id != way->nodes[way->node_count - 1].id)
			continue;
		double twice = 0.0;
		for (size_t j = 1; j < way->node_count; j++)
			twice += dvec2_cross(
				dvec2_sub(way->nodes[j - 1].at, way->nodes[0].at), dvec2_sub(way->nodes[j].at, way->nodes[0].at));
		votes += twice * way->oneway > 0.0 ? 1 : -1;
	}
	return votes;
}

bool traffic_side_right(const struct city *city, const struct osm_store *store)
{
	int tagged = 0;
	for (size_t i = 0; i < store->ways.count; i++) {
		const struct osm_tags *tags = &store->ways.items[i].tags;
		tagged += osm_tag_is(tags, "driving_side", "right");
		tagged -= osm_tag_is(tags, "driving_side", "left");
	}
	if (tagged)
		return tagged > 0;
	int votes = roundabout_votes(city);
	return votes ? votes > 0 : traffic_side_right_at(city->frame.origin);
}
