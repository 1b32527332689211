#include "render/repr.h"

#include <string.h>

const struct repr_ops *repr_by_name(const char *name, const struct pkg *pkg)
{
	static const struct repr_ops *const all[] = { &repr_full, &repr_none, &repr_impostor, &repr_pvs };
	if (!strcmp(name, "auto"))
		return pkg->stretches ? &repr_impostor : &repr_full;
	for (size_t i = 0; i < sizeof(all) / sizeof(all[0]); i++)
		if (!strcmp(all[i]->name, name))
			return all[i];
	return NULL;
}
