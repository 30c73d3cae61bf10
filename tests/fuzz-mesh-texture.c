/* Any bytes as what lies beside a mesh: a picture, and its materials. */
#include "process/mesh-texture.h"
#include "tests/fuzz-import.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const char mesh[] = "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
			   "usemtl wall\nf 1/1 2/2 3/3\n";

static char *write_beside(const char *folder, const char *name, const void *bytes, size_t length)
{
	char *path = g_build_filename(folder, name, NULL);
	g_assert_true(g_file_set_contents_full(
		path, bytes, (gssize)length, G_FILE_SET_CONTENTS_NONE, 0600, NULL));
	return path;
}

static void import_beside(const char *folder)
{
	g_autofree char *path = write_beside(folder, "a.obj", mesh, strlen(mesh));
	g_autoptr(GError) error = NULL;
	import_source *file = import_source_open(path, &error);
	g_assert_no_error(error);
	fuzz_import_file(&import_mesh, file);
}

static void read_picture(const char *path)
{
	static const double at[][3] = { { 0, 0, 0 }, { 1.5, -0.25, 0.01 }, { 0.3, 0.7, 1 } };
	g_autoptr(GError) error = NULL;
	g_autoptr(mesh_texture) t = mesh_texture_read(path, 4096, &error);
	g_assert_true((t == NULL) == (error != NULL));
	if (error)
		g_assert_true(g_str_has_prefix(error->message, path) &&
			      g_utf8_validate(error->message, -1, NULL));
	g_assert_true(!t || (mesh_texture_texels(t) > 0 && mesh_texture_texels(t) <= 4096));
	for (size_t i = 0; t && i < G_N_ELEMENTS(at); i++) {
		uint8_t rgb[3];
		mesh_texture_at(t, at[i][0], at[i][1], at[i][2], rgb);
	}
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
	g_autofree char *folder = g_dir_make_tmp("pleinair-fuzz-XXXXXX", NULL);
	g_assert_nonnull(folder);
	g_autofree char *picture = write_beside(folder, "a.png", data, size), *materials = NULL;
	read_picture(picture);
	/* assimp takes its time, and there is nothing in a picture for it. */
	if (size && data[0] < 0x80) {
		materials = write_beside(folder, "a.mtl", data, size);
		import_beside(folder);
	}
	fuzz_remove(folder);
	return 0;
}
