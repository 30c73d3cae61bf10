#version 310 es
/* Where the strokes of each view begin, so that they have one order whatever was done first; and the command that draws them. One
 * group in all. */
precision highp int;
layout(local_size_x = 256) in;
layout(std430, binding = 5) buffer Marks {
	uint marks[]; /* as marks.glsl has them */
};
layout(std430, binding = 6) buffer Commands {
	uvec4 commands[64]; /* of each layer */
	uint totals[64];
};
layout(location = 0) uniform uint count; /* of views */
layout(location = 1) uniform uint layer;
layout(location = 2) uniform uint capacity; /* of the buffer of strokes */
const uint THREADS = 256u;

void main()
{
	uint thread = gl_LocalInvocationIndex, share = (count + THREADS - 1u) / THREADS;
	uint from = min(thread * share, count), end = min(from + share, count), sum = 0u;
	for (uint n = from; n < end; n++)
		sum += marks[n];
	uint at = before(thread, sum);
	memoryBarrierBuffer();
	barrier();
	for (uint n = from; n < end; n++) {
		uint own = marks[n];
		marks[n] = at;
		at += own;
	}
	if (thread != THREADS - 1u)
		return;
	marks[count] = at;
	commands[layer] = uvec4(4u, min(at, capacity), 0u, 0u);
	totals[layer] = at;
}
