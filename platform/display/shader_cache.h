/*
 * The compiled shaders that Mesa keeps in the user's cache folder: a start that finds them needs a third of the
 * processor time. Their index is a file with holes that Mesa maps. Where the disk is full, writing into a hole ends the
 * process (SIGBUS), and the next start, too. So the index gets its blocks while there are some; where there are none,
 * this process does without the cache. Where the driver is not Mesa's nothing happens.
 *
 * At start only, before and after a display is opened; the environment is changed, so no other thread may read it then.
 */
#ifndef BLVD_PLATFORM_DISPLAY_SHADER_CACHE_H
#define BLVD_PLATFORM_DISPLAY_SHADER_CACHE_H

/* Before EGL is started. Sets MESA_SHADER_CACHE_DISABLE, and says so, where the index is not whole and cannot be. */
void shader_cache_check(void);
/* With a context, by when the index is there: gives it its blocks. */
void shader_cache_reserve(void);

#endif
