#ifndef RENDER_LANES_PATH_H
#define RENDER_LANES_PATH_H
/* What is done for eight points or pixels at a time, or sixteen, stands in files named *-lanes.c, which are built once for each kind of processor
 * (render/module.mk): the same bytes from all of them. Their functions have the kind behind their names. */

enum lanes_path {
	LANES_PORTABLE,
#if defined __x86_64__
	LANES_AVX2,
	LANES_AVX512, /* of its vectors those of eight, with masks; of sixteen where a file asks for them (process/lanes.h) */
#endif
	LANES_PATHS
};
/* The last one that this processor has the vectors for. */
enum lanes_path lanes_path_widest(void);

#if defined __x86_64__
#define LANES_DECLARE(type, name, arguments)                                                       \
	type name##_portable arguments;                                                            \
	type name##_avx2 arguments;                                                                \
	type name##_avx512 arguments
#define LANES_OF(path, name)                                                                       \
	((__typeof__(&name##_portable)[]){ name##_portable, name##_avx2, name##_avx512 }[path])
#else
#define LANES_DECLARE(type, name, arguments) type name##_portable arguments
#define LANES_OF(path, name)                 name##_portable
#endif

/* In *-lanes.c, the name of a function that is declared so. */
#define LANES_JOIN(name, path)      name##_##path
#define LANES_JOIN_LATE(name, path) LANES_JOIN(name, path)
#define LANES_NAME(name)            LANES_JOIN_LATE(name, LANES_BUILT_FOR)

#endif
