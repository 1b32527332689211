#include "tools/bake/bake.h"
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
