/* The route ribbon and the arrow over the next junction; struct ribbon_constants of render/route_ribbon.c. */


uniform highp vec4 u_draw[10];

layout(location = 0) in vec3 a_pos; /* metres from the path's origin; the middle */
layout(location = 1) in vec2 a_side;
layout(location = 2) in float a_lateral;
layout(location = 3) in float a_s;

out float v_lateral;
out float v_s; /* metres ahead of the car */

void main()
{
	mat4 clip_from_eye = mat4(u_draw[0], u_draw[1], u_draw[2], u_draw[3]);
	v_lateral = a_lateral;
	v_s = a_s - u_draw[4].w;
	vec4 middle = clip_from_eye * vec4(a_pos + u_draw[4].xyz, 1.0);
	/* 1.6 m is half the usual width: wide enough to be seen from high above */
	float widen = max(1.0, u_draw[8].w * middle.w / 1.6);
	gl_Position = middle + clip_from_eye * vec4(a_side * (a_lateral * widen), 0.0, 0.0);
}
