#include "tools/read/osm_parse.h"

#include <errno.h>
#include <math.h>
#include <readosm.h>
#include <string.h>

#include "platform/base/log.h"
#include "tools/read/osm_check.h"

static struct osm_tags keep_tags(struct osm_store *store, int count, const readosm_tag *from, int64_t id)
{
	if (count <= 0)
		return (struct osm_tags){ 0 };
	struct osm_tag *tags = POOL_ARRAY(&store->pool, struct osm_tag, count);
	for (int i = 0; i < count; i++) {
		tags[i].key = osm_store_text(store, from[i].key ? from[i].key : "", id);
		tags[i].value = osm_store_text(store, from[i].value ? from[i].value : "", id);
	}
	return (struct osm_tags){ tags, (size_t)count };
}

static int on_node(const void *data, const readosm_node *from)
{
	struct osm_store *store = (struct osm_store *)(uintptr_t)data;
	struct osm_node node = {
		.id = from->id,
		.lat_deg = from->latitude,
		.lon_deg = from->longitude,
		.tags = keep_tags(store, from->tag_count, from->tags, from->id),
		.fate = ELEMENT_IGNORED,
	};
	/* Negated so that NAN is bad too. */
	node.bad = !(fabs(node.lat_deg) <= 90.0 && fabs(node.lon_deg) <= 180.0);
	if (node.bad) {
		report_fault(store->report, FAULT_BAD_NUMBER, FAULT_DROPPED, node.id);
		node.fate = ELEMENT_FAULTY;
	}
	osm_store_add_node(store, &node);
	return READOSM_OK;
}

static int on_way(const void *data, const readosm_way *from)
{
	struct osm_store *store = (struct osm_store *)(uintptr_t)data;
	size_t count = from->node_ref_count > 0 ? (size_t)from->node_ref_count : 0;
	int64_t *refs = POOL_ARRAY(&store->pool, int64_t, count);
	for (size_t i = 0; i < count; i++)
		refs[i] = from->node_refs[i];
	osm_store_add_way(store, &(struct osm_way){ .id = from->id,
								 .refs = refs,
								 .ref_count = count,
								 .tags = keep_tags(store, from->tag_count, from->tags, from->id),
								 .fate = ELEMENT_IGNORED });
	return READOSM_OK;
}

static int on_relation(const void *data, const readosm_relation *from)
{
	struct osm_store *store = (struct osm_store *)(uintptr_t)data;
	size_t count = from->member_count > 0 ? (size_t)from->member_count : 0;
	struct osm_member *members = POOL_ARRAY(&store->pool, struct osm_member, count);
	for (size_t i = 0; i < count; i++) {
		const readosm_member *member = &from->members[i];
		members[i] = (struct osm_member){
			.ref = member->id,
			.role = osm_store_text(store, member->role ? member->role : "", from->id),
			.kind = member->member_type == READOSM_MEMBER_NODE  ? OSM_MEMBER_NODE
					: member->member_type == READOSM_MEMBER_WAY ? OSM_MEMBER_WAY
																: OSM_MEMBER_RELATION,
		};
	}
	osm_store_add_relation(store, &(struct osm_relation){ .id = from->id,
									  .members = members,
									  .member_count = count,
									  .tags = keep_tags(store, from->tag_count, from->tags, from->id),
									  .fate = ELEMENT_IGNORED });
	return READOSM_OK;
}

static int check(struct osm_store *store, struct staged *staged, const char *name)
{
	uint64_t mended;
	if (staged->format == INPUT_OSM_PBF)
		return osm_check_pbf(staged->path, name);
	int status = stage_mend_text(staged, name, &mended);
	if (status)
		return status;
	for (uint64_t i = 0; i < mended; i++)
		report_fault(store->report, FAULT_BAD_STRING, FAULT_MENDED, 0);
	return osm_check_xml(staged->path, name);
}

int osm_parse(struct osm_store *store, struct staged *staged, const char *name)
{
	int status = check(store, staged, name);
	if (status)
		return status;
	const void *handle = NULL;
	int code = readosm_open(staged->path, &handle);
	if (code == READOSM_OK)
		code = readosm_parse(handle, store, on_node, on_way, on_relation);
	readosm_close(handle);
	if (code != READOSM_OK) {
		log_error("%s: readosm cannot read it (its error %d)", name, code);
		return -EBADMSG;
	}
	return 0;
}
