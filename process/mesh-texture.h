#ifndef PROCESS_MESH_TEXTURE_H
#define PROCESS_MESH_TEXTURE_H
/* A picture on a mesh, PNG or JPEG, and its halves, quarters and so on (Williams 1983, "Pyramidal parametrics"), so that a point that
 * stands for many texels has the mean of them. The file is not trusted. const once read. */
#include <glib.h>
#include <stdbool.h>
#include <stdint.h>

typedef struct mesh_texture mesh_texture;
/* With at most so many texels: a larger picture is read smaller. Errors are of G_IO_ERROR, and begin with the path. */
mesh_texture *mesh_texture_read(const char *path, uint64_t texels_most, GError **error);
void mesh_texture_free(mesh_texture *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(mesh_texture, mesh_texture_free)
uint64_t mesh_texture_texels(const mesh_texture *t);

/* u, v: 0..1 across the picture from its lower left corner, beyond which it goes on again. area: of what is asked for, in pictures. */
void mesh_texture_at(const mesh_texture *t, double u, double v, double area, uint8_t ret[3]);

#endif
