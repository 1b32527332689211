/* The finished picture over the whole window, turned. */
uniform highp vec4 u_draw[1]; /* cosine and sine of the turn, clockwise; factor of colours */

out vec2 v_uv;

void main()
{
	vec2 corner = vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1)) * 2.0 - 1.0;
	vec2 turned = vec2(u_draw[0].x * corner.x - u_draw[0].y * corner.y, u_draw[0].y * corner.x + u_draw[0].x * corner.y);
	v_uv = turned * 0.5 + 0.5;
	gl_Position = vec4(corner, 0.0, 1.0);
}
