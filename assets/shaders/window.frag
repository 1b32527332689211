uniform sampler2D u_picture;
uniform highp vec4 u_draw[1];

in vec2 v_uv;

layout(location = 0) out vec4 o_color;

void main()
{
	o_color = vec4(texture(u_picture, v_uv).rgb * u_draw[0].z, 1.0);
}
