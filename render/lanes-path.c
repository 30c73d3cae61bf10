#include "render/lanes-path.h"

enum lanes_path lanes_path_widest(void)
{
#if defined __x86_64__
	if (__builtin_cpu_supports("x86-64-v4"))
		return LANES_AVX512;
	if (__builtin_cpu_supports("avx2"))
		return LANES_AVX2;
#endif
	return LANES_PORTABLE;
}
