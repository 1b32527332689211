/* The shader sources of assets/shaders, embedded at build time. */
#ifndef BLVD_RENDER_SHADER_FILES_H
#define BLVD_RENDER_SHADER_FILES_H

struct shader_file {
	const char *name; /* "near.vert"; NULL ends the list */
	const char *text; /* NUL-terminated GLSL, without a #version line */
};

extern const struct shader_file shader_files[];

#endif
