#include "tests/tools/gl_blocks.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

#include <cmocka.h>

static const char vertex_source[] = "#version 300 es\n"
									"void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, "
									"gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }";
static const char fragment_source[] = "#version 300 es\n"
									  "precision highp float; uniform highp sampler2D u_blocks; out vec4 colour;\n"
									  "void main() { colour = texelFetch(u_blocks, ivec2(gl_FragCoord.xy), 0); }";

static void attach_shader(GLuint program, GLenum kind, const char *source)
{
	GLuint shader = glCreateShader(kind);
	glShaderSource(shader, 1, &source, NULL);
	glCompileShader(shader);
	glAttachShader(program, shader);
}

void gl_draw_blocks(GLenum format, const uint8_t *blocks, size_t bytes, int side, uint8_t (*out)[4])
{
	GLuint textures[2], target, program = glCreateProgram();
	glGenTextures(2, textures);
	glBindTexture(GL_TEXTURE_2D, textures[1]);
	glTexStorage2D(GL_TEXTURE_2D, 1, GL_RGBA8, side, side);
	glGenFramebuffers(1, &target);
	glBindFramebuffer(GL_FRAMEBUFFER, target);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, textures[1], 0);
	glBindTexture(GL_TEXTURE_2D, textures[0]);
	glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
	glTexStorage2D(GL_TEXTURE_2D, 1, format, side, side);
	glCompressedTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, side, side, format, (GLsizei)bytes, blocks);
	attach_shader(program, GL_VERTEX_SHADER, vertex_source);
	attach_shader(program, GL_FRAGMENT_SHADER, fragment_source);
	glLinkProgram(program);
	glUseProgram(program);
	glViewport(0, 0, side, side);
	glDrawArrays(GL_TRIANGLES, 0, 3);
	glReadPixels(0, 0, side, side, GL_RGBA, GL_UNSIGNED_BYTE, out);
	assert_int_equal(glGetError(), GL_NO_ERROR);
}
