#version 310 es
/* All of the picture, or what the scissors leave of it. */
void main()
{
	gl_Position = vec4(float(gl_VertexID & 1) * 4.0 - 1.0, float(gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
