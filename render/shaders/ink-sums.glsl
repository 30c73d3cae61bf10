/* What strokes leave in pixels, as whole numbers, whose sums are the same in whatever order they come: planes of a word for each pixel
 * (gles-ink.h). Factors as octaves that they take away; sums in parts; of paint sums below its highest power of two, which comes first. A
 * pixel has room for 16384 strokes that cover it whole. */
const float OCTAVE = 16384.0, OCTAVES_MOST = 16.0, PART = 65536.0;
const int POWER_ZERO = 160;

uint taken(float left)
{
	return uint(min(-log2(max(left, 1e-6)), OCTAVES_MOST) * OCTAVE + 0.5);
}

float left_of(uint taken)
{
	return exp2(-float(taken) * (1.0 / OCTAVE));
}

uint parts(float x)
{
	return uint(x * PART + 0.5);
}
