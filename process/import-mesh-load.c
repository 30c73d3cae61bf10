/* Files of meshes by assimp. */
#include "firmware-io/files.h"
#include "process/import-cloud.h"
#include "process/import-mesh.h"
#include <assimp/cfileio.h>
#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define FILE_BYTES_MAX     (UINT64_C(2) << 30)
#define MATERIAL_BYTES_MAX (16u << 20)
#define COORDINATE_MAX     1e9
#define NAME               "mesh."
/* Of all textures together. */
#define TEXELS_MAX   (UINT64_C(192) << 20)
#define TEXTURES_MAX 4096

/* ---- files for assimp: the bytes at hand, and the materials beside an OBJ ---- */

struct opened {
	struct aiFile file;
	const uint8_t *bytes;
	size_t length, at;
	char *own; /* NULL: borrowed */
};

struct files {
	struct aiFileIO io;
	const uint8_t *bytes;
	size_t length;
	const char *folder; /* where materials and textures may lie; NULL: nowhere */
	bool wanted_material, has_material;
};

static size_t read_file(struct aiFile *f, char *into, size_t size, size_t count)
{
	struct opened *o = (struct opened *)f->UserData;
	size_t whole = size ? MIN(count, (o->length - o->at) / size) : 0;
	memcpy(into, o->bytes + o->at, whole * size);
	o->at += whole * size;
	return whole;
}

static size_t write_file(struct aiFile *f, const char *from, size_t size, size_t count)
{
	(void)f;
	(void)from;
	(void)size;
	(void)count;
	return 0;
}

static size_t tell_file(struct aiFile *f)
{
	return ((struct opened *)f->UserData)->at;
}

static size_t size_file(struct aiFile *f)
{
	return ((struct opened *)f->UserData)->length;
}

static enum aiReturn seek_file(struct aiFile *f, size_t offset, enum aiOrigin origin)
{
	struct opened *o = (struct opened *)f->UserData;
	size_t from = origin == aiOrigin_SET ? 0 : origin == aiOrigin_CUR ? o->at : o->length;
	if (offset > o->length - from)
		return aiReturn_FAILURE;
	o->at = from + offset;
	return aiReturn_SUCCESS;
}

static void flush_file(struct aiFile *f)
{
	(void)f;
}

static struct aiFile *opened_new(const uint8_t *bytes, size_t length, char *own)
{
	struct opened *o = g_new0(struct opened, 1);
	o->bytes = bytes;
	o->length = length;
	o->own = own;
	o->file = (struct aiFile){ read_file, write_file, tell_file, size_file, seek_file,
		flush_file, (aiUserData)o };
	return &o->file;
}

static struct aiFile *open_material(struct files *f, const char *name)
{
	g_autofree char *base = g_path_get_basename(name),
			*path = f->folder ? g_build_filename(f->folder, base, NULL) : NULL;
	size_t length;
	f->wanted_material = true;
	g_autofree char *bytes = path ? files_read(path, MATERIAL_BYTES_MAX, &length, NULL) : NULL;
	if (!bytes)
		return NULL;
	char *of_use = mesh_materials(bytes, length, &length);
	f->has_material = true;
	return opened_new((const uint8_t *)of_use, length, of_use);
}

static struct aiFile *open_file(struct aiFileIO *io, const char *name, const char *mode)
{
	struct files *f = (struct files *)io->UserData;
	if (strchr(mode, 'w') || strchr(mode, 'a'))
		return NULL;
	if (g_str_has_prefix(name, NAME))
		return opened_new(f->bytes, f->length, NULL);
	return g_str_has_suffix(name, ".mtl") ? open_material(f, name) : NULL;
}

static void close_file(struct aiFileIO *io, struct aiFile *file)
{
	struct opened *o = (struct opened *)file->UserData;
	(void)io;
	g_free(o->own);
	g_free(o);
}

/* ---- the scene as one mesh ---- */

static bool is_sound(const struct aiMesh *part)
{
	for (unsigned i = 0; i < part->mNumVertices; i++) {
		const struct aiVector3D *v = &part->mVertices[i];
		if (!(fabs((double)v->x) <= COORDINATE_MAX &&
			    fabs((double)v->y) <= COORDINATE_MAX &&
			    fabs((double)v->z) <= COORDINATE_MAX))
			return false;
	}
	for (unsigned i = 0; i < part->mNumFaces; i++)
		for (unsigned k = 0; k < part->mFaces[i].mNumIndices; k++)
			if (part->mFaces[i].mIndices[k] >= part->mNumVertices)
				return false;
	return true;
}

static uint64_t triangles_of(const struct aiMesh *part)
{
	uint64_t count = 0;
	for (unsigned i = 0; i < part->mNumFaces; i++)
		count += part->mFaces[i].mNumIndices >= 3 ? part->mFaces[i].mNumIndices - 2 : 0;
	return count;
}

/* What is no number is black. */
static uint8_t byte_of(float share)
{
	return share > 0 ? (uint8_t)(fmin((double)share, 1) * 255 + 0.5) : 0;
}

/* A vertex's own colour, else its material's. */
static void colour_of(const struct aiMesh *part, unsigned vertex, const struct aiColor4D *material,
	uint8_t ret[3])
{
	const struct aiColor4D *c = part->mColors[0] ? &part->mColors[0][vertex] : material;
	ret[0] = byte_of(c->r);
	ret[1] = byte_of(c->g);
	ret[2] = byte_of(c->b);
}

/* ---- textures, beside an OBJ or PLY ---- */

/* The path of the picture that colours what is of a material; NULL: none. Nothing outside the folder is named. */
static char *texture_path(const struct aiMaterial *material, const char *folder)
{
	struct aiString name = { 0 };
	if (!folder || aiGetMaterialTexture(material, aiTextureType_DIFFUSE, 0, &name, NULL, NULL,
			       NULL, NULL, NULL, NULL) != aiReturn_SUCCESS)
		return NULL;
	g_autofree char *plain = g_strdelimit(g_strndup(name.data, name.length), "\\", '/');
	g_autofree char *base = g_path_get_basename(plain);
	bool inside = *plain && !g_path_is_absolute(plain) && !strstr(plain, "..");
	g_autofree char *path = g_build_filename(folder, inside ? plain : base, NULL);
	/* Pictures are moved more often than the names of them are mended. */
	if (inside && !g_file_test(path, G_FILE_TEST_EXISTS))
		return g_build_filename(folder, base, NULL);
	return g_steal_pointer(&path);
}

struct textures {
	GPtrArray *all; /* of mesh_texture */
	int16_t *of_material;
};

static void textures_clear(struct textures *t)
{
	g_clear_pointer(&t->all, g_ptr_array_unref);
	g_clear_pointer(&t->of_material, g_free);
}

/* Of each material; NULL: none. */
static GPtrArray *paths_of(const struct aiScene *scene, const char *folder)
{
	GPtrArray *paths = g_ptr_array_new_full(scene->mNumMaterials, g_free);
	for (unsigned i = 0; i < scene->mNumMaterials; i++)
		g_ptr_array_add(paths, texture_path(scene->mMaterials[i], folder));
	return paths;
}

static unsigned count_different(const GPtrArray *paths)
{
	g_autoptr(GHashTable) different = g_hash_table_new(g_str_hash, g_str_equal);
	for (guint i = 0; i < paths->len; i++)
		if (paths->pdata[i])
			g_hash_table_add(different, paths->pdata[i]);
	return g_hash_table_size(different);
}

static void tell_missing(GString *notes, unsigned missing, unsigned count, const GError *first)
{
	g_autofree char *why = g_utf8_make_valid(first->message, -1); /* a name of a file */
	g_string_append_printf(
		notes, "%u of its %u textures could not be read (%s)", missing, count, why);
}

/* What cannot be read is left out, and the first of them told. */
static struct textures load_textures(
	const struct aiScene *scene, const char *folder, GString *notes)
{
	unsigned materials = scene->mNumMaterials;
	struct textures t = { g_ptr_array_new_with_free_func((GDestroyNotify)mesh_texture_free),
		g_new(int16_t, materials + 1) };
	g_autoptr(GPtrArray) paths = paths_of(scene, folder);
	g_autoptr(GHashTable) index = g_hash_table_new(g_str_hash, g_str_equal);
	unsigned missing = 0, count = count_different(paths);
	g_autoptr(GError) first = NULL;
	for (unsigned i = 0; i < materials; i++) {
		gpointer at, path = paths->pdata[i];
		t.of_material[i] = -1;
		if (!path || t.all->len == TEXTURES_MAX)
			continue;
		if (g_hash_table_lookup_extended(index, path, NULL, &at)) {
			t.of_material[i] = (int16_t)GPOINTER_TO_INT(at);
			continue;
		}
		mesh_texture *one =
			mesh_texture_read(path, TEXELS_MAX / count, first ? NULL : &first);
		missing += !one;
		if (one) {
			t.of_material[i] = (int16_t)t.all->len;
			g_ptr_array_add(t.all, one);
		}
		g_hash_table_insert(index, path, GINT_TO_POINTER(t.of_material[i]));
	}
	if (missing)
		tell_missing(notes, missing, count, first);
	return t;
}

/* Before its colours; m has textures. */
static void put_texture(mesh *m, uint32_t triangle, int corner, const struct aiMesh *part,
	unsigned vertex, int16_t texture)
{
	const struct aiVector3D *uv = &part->mTextureCoords[0][vertex];
	m->texture[triangle] = texture;
	m->uv[triangle][corner][0] = uv->x;
	m->uv[triangle][corner][1] = uv->y;
}

/* ---- faces ---- */

/* What a face has from its material. */
struct cover {
	struct aiColor4D colour;
	int16_t texture; /* below 0: none */
};

static void add_face(mesh *m, const struct aiMesh *part, const struct aiFace *face, uint32_t first,
	const struct cover *cover, uint32_t *triangle)
{
	if (face->mNumIndices < 3)
		return;
	uint32_t count = face->mNumIndices;
	g_autofree uint32_t *vertices = g_new(uint32_t, count),
			    *cut = g_new(uint32_t, 3 * (size_t)(count - 2));
	for (uint32_t k = 0; k < count; k++)
		vertices[k] = first + face->mIndices[k];
	mesh_cut_polygon(m, vertices, count, cut);
	for (uint32_t t = 0; t < count - 2; t++, (*triangle)++)
		for (int k = 0; k < 3; k++) {
			uint32_t corner = cut[3 * t + (uint32_t)k];
			m->corner[*triangle][k] = vertices[corner];
			if (m->rgb)
				colour_of(part, face->mIndices[corner], &cover->colour,
					m->rgb[*triangle][k]);
			if (cover->texture >= 0)
				put_texture(m, *triangle, k, part, face->mIndices[corner],
					cover->texture);
		}
}

static struct cover cover_of(
	const struct aiScene *scene, const struct aiMesh *part, const struct textures *textures)
{
	struct cover c = { { 1, 1, 1, 1 }, -1 };
	if (part->mMaterialIndex >= scene->mNumMaterials)
		return c;
	aiGetMaterialColor(
		scene->mMaterials[part->mMaterialIndex], AI_MATKEY_COLOR_DIFFUSE, &c.colour);
	if (part->mTextureCoords[0])
		c.texture = textures->of_material[part->mMaterialIndex];
	return c;
}

static void add_part(mesh *m, const struct aiScene *scene, const struct aiMesh *part,
	const struct textures *textures, uint32_t first, uint32_t *triangle)
{
	struct cover cover = cover_of(scene, part, textures);
	for (unsigned i = 0; i < part->mNumVertices; i++) {
		m->at_m[first + i][0] = (double)part->mVertices[i].x;
		m->at_m[first + i][1] = (double)part->mVertices[i].y;
		m->at_m[first + i][2] = (double)part->mVertices[i].z;
	}
	for (unsigned i = 0; i < part->mNumFaces; i++)
		add_face(m, part, &part->mFaces[i], first, &cover, triangle);
}

static bool refuse(import_source *file, const char *what, GError **error)
{
	return import_refuse(error, file, G_IO_ERROR_INVALID_DATA, "%s", what);
}

/* Takes the textures. */
static mesh *mesh_of(const struct aiScene *scene, struct textures *textures, bool has_material,
	import_source *file, GError **error)
{
	uint64_t vertices = 0, triangles = 0;
	bool colour = has_material || textures->all->len;
	for (unsigned i = 0; i < scene->mNumMeshes; i++) {
		vertices += scene->mMeshes[i]->mNumVertices;
		triangles += triangles_of(scene->mMeshes[i]);
		colour |= scene->mMeshes[i]->mColors[0] != NULL;
	}
	if (!triangles || vertices > INT32_MAX || triangles > INT32_MAX)
		return refuse(file, triangles ? "has too many triangles" : "has no triangles",
			       error),
		       NULL;
	mesh *m = mesh_new((uint32_t)vertices, (uint32_t)triangles, colour);
	if (textures->all->len)
		mesh_add_textures(m, g_steal_pointer(&textures->all));
	uint32_t first = 0, triangle = 0;
	for (unsigned i = 0; i < scene->mNumMeshes; i++) {
		add_part(m, scene, scene->mMeshes[i], textures, first, &triangle);
		first += scene->mMeshes[i]->mNumVertices;
	}
	return m;
}

static bool check_parts(const struct aiScene *scene, import_source *file, GError **error)
{
	for (unsigned i = 0; i < scene->mNumMeshes; i++)
		if (!is_sound(scene->mMeshes[i]))
			return refuse(file,
				"names vertices that are not there, or that are too far", error);
	return true;
}

static mesh *load(
	struct files *f, import_source *file, const char *name, GString *notes, GError **error)
{
	const struct aiScene *scene = aiImportFileEx(name, 0, &f->io);
	if (!scene) {
		g_autofree char *why = g_utf8_make_valid(aiGetErrorString(), -1);
		import_refuse(error, file, G_IO_ERROR_INVALID_DATA, "cannot be read as a mesh: %s",
			g_strstrip(g_strdelimit(why, "\n", ' ')));
		return NULL;
	}
	mesh *m = NULL;
	if (check_parts(scene, file, error)) {
		struct textures textures = load_textures(scene, f->folder, notes);
		m = mesh_of(scene, &textures, f->has_material, file, error);
		textures_clear(&textures);
	}
	aiReleaseImport(scene);
	return m;
}

/* What should be one. */
static bool is_text(const uint8_t *bytes, size_t length, enum mesh_kind kind)
{
	bool should = kind == MESH_OFF || kind == MESH_OBJ ||
		      (kind == MESH_STL && length > 6 && !memcmp(bytes, "solid", 5) &&
			      memmem(bytes, MIN(length, 512), "facet", 5));
	return !should || !memchr(bytes, 0, length);
}

mesh *mesh_load(import_source *file, enum mesh_kind kind, GString *notes, GError **error)
{
	static const char *const names[] = { [MESH_OFF] = NAME "off",
		[MESH_OBJ] = NAME "obj",
		[MESH_PLY] = NAME "ply",
		[MESH_STL] = NAME "stl" };
	if (import_source_size(file) > FILE_BYTES_MAX)
		return import_refuse(error, file, G_IO_ERROR_NOT_SUPPORTED,
			       "is larger than 2 GiB, which is as much as is read of a mesh"),
		       NULL;
	size_t length;
	g_autofree uint8_t *bytes = import_load(file, 0, &length, error);
	g_autofree char *folder = g_path_get_dirname(import_source_path(file));
	if (!bytes)
		return NULL;
	if (!is_text(bytes, length, kind)) {
		const uint8_t *zero = memchr(bytes, 0, length);
		import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			"byte %zu: a zero byte cannot stand in a text", (size_t)(zero - bytes));
		return NULL;
	}
	struct files f = { .bytes = bytes,
		.length = length,
		.folder = import_source_is_file(file) ? folder : NULL };
	f.io = (struct aiFileIO){ open_file, close_file, (aiUserData)&f };
	mesh *m = load(&f, file, names[kind], notes, error);
	if (m && f.wanted_material && !f.has_material)
		g_string_append(
			notes, "its materials were not beside it, so their colours are missing");
	return m;
}
