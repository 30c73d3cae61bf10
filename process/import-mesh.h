#ifndef PROCESS_IMPORT_MESH_H
#define PROCESS_IMPORT_MESH_H
/* What the files of the mesh reader share. assimp reads the files; but it believes what they tell, so that what they tell is looked
 * through before: every count and every index. */
#include "process/import.h"
#include "process/mesh.h"

enum mesh_kind { MESH_NONE, MESH_OFF, MESH_OBJ, MESH_PLY, MESH_STL };
/* By the beginning of a file; a binary STL only where all of it is there. */
enum mesh_kind mesh_kind_of(const uint8_t *start, size_t length);
/* By the whole file, of whatever name. */
bool mesh_check(import_source *file, enum mesh_kind kind, GError **error);
/* Of a file of materials beside an OBJ what is of use here, as such a file; caller frees. */
char *mesh_materials(const char *text, size_t length, size_t *ret_length);
/* Of a file that was checked, in its own units. What else should be said is appended to notes. */
mesh *mesh_load(import_source *file, enum mesh_kind kind, GString *notes, GError **error);

#endif
