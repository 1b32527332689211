/* A rectangle of a camera's picture; corners from gl_VertexID, two triangles as a strip. */
uniform highp vec4 u_draw[7]; /* place in clip space; texture places of plane 0 and 1: x0 y0 x1 y1, the top left first */

out highp vec2 v_luma;
out highp vec2 v_chroma;

void main()
{
	vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
	v_luma = mix(u_draw[1].xy, u_draw[1].zw, corner);
	v_chroma = mix(u_draw[2].xy, u_draw[2].zw, corner);
	gl_Position = vec4(mix(u_draw[0].xy, u_draw[0].zw, corner), 0.0, 1.0);
}
