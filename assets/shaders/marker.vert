// The car's own marker: a small solid arrow.
layout(location = 0) in highp vec3 a_position; // m, y ahead
layout(location = 1) in mediump vec3 a_normal;
// 0: place from the eye, m; w scale  1: cos, sin of heading  2 to 5: clip from eye-relative m, by column  6: colour
uniform highp vec4 u_draw[7];
out mediump float v_light;

vec3 turn(vec3 p)
{
	return vec3(p.x * u_draw[1].x + p.y * u_draw[1].y, p.y * u_draw[1].x - p.x * u_draw[1].y, p.z);
}

void main()
{
	vec3 at = turn(a_position) * u_draw[0].w + u_draw[0].xyz;
	gl_Position = mat4(u_draw[2], u_draw[3], u_draw[4], u_draw[5]) * vec4(at, 1.0);
	v_light = 0.78 + 0.22 * dot(turn(a_normal), normalize(vec3(-0.3, -0.5, 0.8)));
}
