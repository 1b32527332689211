in mediump float v_light;
uniform highp vec4 u_draw[7];
out mediump vec4 o_color;

void main()
{
	o_color = vec4(u_draw[6].rgb * v_light, u_draw[6].a);
}
