/* GLSL ES 3.10. The samples of a pixel, averaged: what a blit does, where GL's own is slow to come up. */
uniform highp sampler2DMS u_samples;

layout(location = 0) out vec4 o_color;

void main()
{
	ivec2 at = ivec2(gl_FragCoord.xy);
	vec4 sum = texelFetch(u_samples, at, 0);
	for (int i = 1; i < SAMPLES; i++)
		sum += texelFetch(u_samples, at, i);
	o_color = sum * (1.0 / float(SAMPLES));
}
