#include "render/lanes-path.h"
#include <stdbool.h>

#if defined __x86_64__
/* x86-64-v4, of which clang 14 knows only the parts, and permutations of bytes. */
static bool has_avx512(void)
{
	return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
	       __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
	       __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vbmi") &&
	       __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi2") &&
	       __builtin_cpu_supports("fma");
}
#endif

enum lanes_path lanes_path_widest(void)
{
#if defined __x86_64__
	if (has_avx512())
		return LANES_AVX512;
	if (__builtin_cpu_supports("avx2"))
		return LANES_AVX2;
#endif
	return LANES_PORTABLE;
}
