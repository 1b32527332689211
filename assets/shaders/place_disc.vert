// Where the car may be: an ellipse on the ground around it.
layout(location = 0) in highp vec2 a_corner; // -1 to 1, y along the longer axis
// 0: place from the eye, m; w 1 / (1 + margin)  1: half axes, m (x shorter, y longer), cos, sin of the longer one's heading
// 2 to 5: clip from eye-relative m, by column  6: colour
uniform highp vec4 u_draw[7];
out highp vec2 v_at; // 1 on the ellipse

void main()
{
	v_at = a_corner / u_draw[0].w;
	vec2 p = v_at * u_draw[1].xy;
	vec2 world = vec2(p.x * u_draw[1].z + p.y * u_draw[1].w, p.y * u_draw[1].z - p.x * u_draw[1].w);
	gl_Position = mat4(u_draw[2], u_draw[3], u_draw[4], u_draw[5]) * vec4(vec3(world, 0.0) + u_draw[0].xyz, 1.0);
}
