#ifndef RENDER_SCENE_LINES_H
#define RENDER_SCENE_LINES_H
/* The profile lines of a site (process/profile-lines.h) as they are drawn: from the scene's origin, with how far each vertex is along its
 * line, and how much room each line has to itself, which tells at what scale it is one line too many. Const once made; one owner. */
#include "process/profile-lines.h"

struct scene_line {
	uint32_t first, count; /* of its vertices */
	float length_m, confidence;
	/* To the nearest line that counts more and runs beside it, in the middle of its length; SCENE_LINES_APART_M where there is none so
	 * near. */
	float apart_m;
	uint16_t leaf;
	uint8_t kind, closed; /* enum profile_kind */
};
#define SCENE_LINES_APART_M 1.f

struct scene_line_vertex {
	float at_m[3], along_m;
	float face[2][3]; /* unit normals of the faces beside it; 0 0 0: none */
};

typedef struct scene_lines scene_lines;
struct scene_lines {
	uint64_t serial; /* scene_serial() */
	uint32_t lines, vertices;
	struct scene_line *line; /* those that count most first */
	struct scene_line_vertex *vertex;
};
scene_lines *scene_lines_new(const profile_lines *p, const double origin_m[3]);
void scene_lines_free(scene_lines *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(scene_lines, scene_lines_free)

#endif
