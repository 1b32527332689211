// One triangle over the whole screen, behind everything.
// 0: forward, 1: right * tan(half width), 2: up * tan(half height); of the view
uniform highp vec4 u_draw[3];
out highp vec3 v_direction;

void main()
{
	vec2 at = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
	v_direction = u_draw[0].xyz + u_draw[1].xyz * at.x + u_draw[2].xyz * at.y;
	gl_Position = vec4(at, 1.0, 1.0);
}
