#include "tools/synth/osm_doc.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "platform/base/log.h"

struct tag {
	const char *key, *value;
};
struct run { /* of an array, from `first` to the next element's */
	uint32_t first_tag, first_ref;
};
struct member {
	char type;
	uint32_t ref;
	const char *role;
};
struct place {
	int32_t lat, lon; /* 1e-7 degree */
	uint32_t first_tag;
};

struct osm_doc {
	struct geo_frame frame;
	struct pool pool;
	ARRAY(struct place) nodes;
	ARRAY(struct run) ways, relations;
	ARRAY(struct tag) node_tags, way_tags, relation_tags;
	ARRAY(uint32_t) refs;
	ARRAY(struct member) members;
	char newest;
	const char *last_keys[64]; /* keys repeat: kept once, by a small hash */
};

struct osm_doc *osm_doc_new(struct geo_frame frame)
{
	size_t capacity = 0;
	struct osm_doc *doc = array_grow(NULL, &capacity, 1, sizeof(*doc));
	*doc = (struct osm_doc){ .frame = frame };
	return doc;
}

void osm_doc_free(struct osm_doc *doc)
{
	if (!doc)
		return;
	ARRAY_FINISH(&doc->nodes);
	ARRAY_FINISH(&doc->ways);
	ARRAY_FINISH(&doc->relations);
	ARRAY_FINISH(&doc->node_tags);
	ARRAY_FINISH(&doc->way_tags);
	ARRAY_FINISH(&doc->relation_tags);
	ARRAY_FINISH(&doc->refs);
	ARRAY_FINISH(&doc->members);
	pool_finish(&doc->pool);
	array_free(doc);
}

uint32_t osm_doc_node(struct osm_doc *doc, struct dvec2 at)
{
	struct geo_point point = geo_from_plane(&doc->frame, at);
	ARRAY_PUSH(&doc->nodes, (struct place){ (int32_t)lround(point.lat_deg * 1e7), (int32_t)lround(point.lon_deg * 1e7),
								(uint32_t)doc->node_tags.count });
	doc->newest = 'n';
	return (uint32_t)doc->nodes.count;
}

uint32_t osm_doc_way(struct osm_doc *doc, const uint32_t *nodes, size_t count)
{
	ARRAY_PUSH(&doc->ways, (struct run){ (uint32_t)doc->way_tags.count, (uint32_t)doc->refs.count });
	for (size_t i = 0; i < count; i++)
		ARRAY_PUSH(&doc->refs, nodes[i]);
	doc->newest = 'w';
	return (uint32_t)doc->ways.count;
}

uint32_t osm_doc_relation(struct osm_doc *doc)
{
	ARRAY_PUSH(&doc->relations, (struct run){ (uint32_t)doc->relation_tags.count, (uint32_t)doc->members.count });
	doc->newest = 'r';
	return (uint32_t)doc->relations.count;
}

void osm_doc_member(struct osm_doc *doc, char type, uint32_t ref, const char *role)
{
	ARRAY_PUSH(&doc->members, (struct member){ type, ref, role });
}

static const char *kept_key(struct osm_doc *doc, const char *key)
{
	size_t slot = strlen(key);
	for (const char *c = key; *c; c++)
		slot = slot * 31 + (unsigned char)*c;
	const char **kept = &doc->last_keys[slot % 64];
	if (!*kept || strcmp(*kept, key) != 0)
		*kept = pool_string(&doc->pool, key);
	return *kept;
}

void osm_doc_tag(struct osm_doc *doc, const char *key, const char *value)
{
	if (!value || !*value)
		return;
	struct tag tag = { kept_key(doc, key), pool_string(&doc->pool, value) };
	if (doc->newest == 'n')
		ARRAY_PUSH(&doc->node_tags, tag);
	else if (doc->newest == 'w')
		ARRAY_PUSH(&doc->way_tags, tag);
	else
		ARRAY_PUSH(&doc->relation_tags, tag);
}

void osm_doc_tag_number(struct osm_doc *doc, const char *key, double value, int decimals)
{
	char text[40];
	snprintf(text, sizeof(text), "%.*f", decimals, value);
	osm_doc_tag(doc, key, text);
}

size_t osm_doc_way_count(const struct osm_doc *doc)
{
	return doc->ways.count;
}

size_t osm_doc_node_count(const struct osm_doc *doc)
{
	return doc->nodes.count;
}

static void write_escaped(FILE *file, const char *text)
{
	for (; *text; text++) {
		switch (*text) {
		case '&':
			fputs("&amp;", file);
			break;
		case '<':
			fputs("&lt;", file);
			break;
		case '>':
			fputs("&gt;", file);
			break;
		case '"':
			fputs("&quot;", file);
			break;
		default:
			if ((unsigned char)*text >= 0x20)
				fputc(*text, file);
		}
	}
}

static void write_tags(FILE *file, const struct tag *tags, size_t from, size_t to)
{
	for (size_t i = from; i < to; i++) {
		fputs("  <tag k=\"", file);
		write_escaped(file, tags[i].key);
		fputs("\" v=\"", file);
		write_escaped(file, tags[i].value);
		fputs("\"/>\n", file);
	}
}

static void write_bounds(FILE *file, const struct osm_doc *doc)
{
	int32_t low_lat = INT32_MAX, low_lon = INT32_MAX, high_lat = INT32_MIN, high_lon = INT32_MIN;
	for (size_t i = 0; i < doc->nodes.count; i++) {
		const struct place *at = &doc->nodes.items[i];
		low_lat = at->lat < low_lat ? at->lat : low_lat;
		high_lat = at->lat > high_lat ? at->lat : high_lat;
		low_lon = at->lon < low_lon ? at->lon : low_lon;
		high_lon = at->lon > high_lon ? at->lon : high_lon;
	}
	if (doc->nodes.count)
		fprintf(file, " <bounds minlat=\"%.7f\" minlon=\"%.7f\" maxlat=\"%.7f\" maxlon=\"%.7f\"/>\n", low_lat / 1e7,
			low_lon / 1e7, high_lat / 1e7, high_lon / 1e7);
}

static void write_nodes(FILE *file, const struct osm_doc *doc)
{
	for (size_t i = 0; i < doc->nodes.count; i++) {
		const struct place *at = &doc->nodes.items[i];
		size_t from = at->first_tag, to = i + 1 < doc->nodes.count ? at[1].first_tag : doc->node_tags.count;
		fprintf(file, " <node id=\"%zu\" version=\"1\" lat=\"%.7f\" lon=\"%.7f\"%s>\n", i + 1, at->lat / 1e7,
			at->lon / 1e7, from == to ? "/" : "");
		if (from == to)
			continue;
		write_tags(file, doc->node_tags.items, from, to);
		fputs(" </node>\n", file);
	}
}

static void write_ways(FILE *file, const struct osm_doc *doc)
{
	for (size_t i = 0; i < doc->ways.count; i++) {
		const struct run *run = &doc->ways.items[i];
		bool last = i + 1 == doc->ways.count;
		fprintf(file, " <way id=\"%zu\" version=\"1\">\n", i + 1);
		for (size_t k = run->first_ref; k < (last ? doc->refs.count : run[1].first_ref); k++)
			fprintf(file, "  <nd ref=\"%u\"/>\n", doc->refs.items[k]);
		write_tags(file, doc->way_tags.items, run->first_tag, last ? doc->way_tags.count : run[1].first_tag);
		fputs(" </way>\n", file);
	}
}

static void write_relations(FILE *file, const struct osm_doc *doc)
{
	for (size_t i = 0; i < doc->relations.count; i++) {
		const struct run *run = &doc->relations.items[i];
		bool last = i + 1 == doc->relations.count;
		fprintf(file, " <relation id=\"%zu\" version=\"1\">\n", i + 1);
		for (size_t k = run->first_ref; k < (last ? doc->members.count : run[1].first_ref); k++) {
			const struct member *m = &doc->members.items[k];
			fprintf(file, "  <member type=\"%s\" ref=\"%u\" role=\"%s\"/>\n", m->type == 'n' ? "node" : "way", m->ref,
				m->role);
		}
		write_tags(file, doc->relation_tags.items, run->first_tag, last ? doc->relation_tags.count : run[1].first_tag);
		fputs(" </relation>\n", file);
	}
}

static int flush(FILE *file)
{
	int error = ferror(file) ? EIO : 0;
	if (fflush(file) || (!error && fsync(fileno(file)) && errno != EINVAL && errno != ENOTSUP))
		error = errno;
	if (fclose(file) && !error)
		error = errno;
	return error;
}

int osm_doc_write(const struct osm_doc *doc, const char *path)
{
	char part[4096];
	if (snprintf(part, sizeof(part), "%s.part", path) >= (int)sizeof(part)) {
		log_error("%s: %s", path, strerror(ENAMETOOLONG));
		return -ENAMETOOLONG;
	}
	FILE *file = fopen(part, "wbe");
	if (!file) {
		int error = errno;
		log_error("%s: %s", part, strerror(error));
		return -error;
	}
	fputs("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<osm version=\"0.6\" generator=\"blvd synth\">\n", file);
	write_bounds(file, doc);
	write_nodes(file, doc);
	write_ways(file, doc);
	write_relations(file, doc);
	fputs("</osm>\n", file);
	int error = flush(file);
	if (!error && rename(part, path))
		error = errno;
	if (error) {
		log_error("%s: %s", path, strerror(error));
		unlink(part);
	}
	return -error;
}
