#include "tools/bake/bake.h"
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
