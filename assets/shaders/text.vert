/* Overlay shapes and glyphs in screen pixels; struct canvas_vertex of render/canvas.h. */


uniform highp vec4 u_draw[1]; /* scale and offset from pixels to clip space */

layout(location = 0) in vec2 a_pos;
layout(location = 1) in vec2 a_uv;
layout(location = 2) in vec4 a_fill;
layout(location = 3) in vec4 a_halo;
layout(location = 4) in vec3 a_field; /* range, halo width, growth: pixels */

out vec4 v_fill;
#ifndef SHAPE
out vec2 v_uv;
out vec4 v_halo;
out vec3 v_field;
#endif

void main()
{
	v_fill = a_fill;
#ifndef SHAPE
	v_uv = a_uv;
	v_halo = a_halo;
	v_field = a_field;
#endif
	gl_Position = vec4(a_pos * u_draw[0].xy + u_draw[0].zw, 0.0, 1.0);
}
