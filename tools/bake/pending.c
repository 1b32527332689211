#include "tools/bake/bake.h"
__attribute__((weak)) void light_map_bake(const struct city *city, const lamp_array *lamps, struct light_map *out)
{
	(void)city;
	(void)lamps;
	*out = (struct light_map){ 0 };
}
__attribute__((weak)) void light_map_finish(struct light_map *map)
{
	(void)map;
}
__attribute__((weak)) void ground_build(
	const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink, lamp_array *lamps)
{
	(void)city;
	(void)graph;
	(void)sink;
	(void)lamps;
}
__attribute__((weak)) void trees_build(const struct city *city, struct mesh_sink *sink)
{
	(void)city;
	(void)sink;
}
__attribute__((weak)) void buildings_build(
	const struct city *city, const struct pkg_graph *graph, struct mesh_sink *sink)
{
	(void)city;
	(void)graph;
	(void)sink;
}
__attribute__((weak)) int text_bake(
	const char *const *f, size_t n, const char *const *s, size_t m, struct text_data *out)
{
	(void)f;
	(void)n;
	(void)s;
	(void)m;
	*out = (struct text_data){ 0 };
	return 0;
}
__attribute__((weak)) void text_data_finish(struct text_data *text)
{
	(void)text;
}
__attribute__((weak)) int paint_ground(struct material_layer *layers)
{
	(void)layers;
	return 1;
}
__attribute__((weak)) int paint_roofs(struct material_layer *layers)
{
	(void)layers;
	return 1;
}
__attribute__((weak)) int paint_walls(struct material_layer *layers)
{
	(void)layers;
	return 1;
}
