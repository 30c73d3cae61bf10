/* Pictures on meshes: which texel a point gets and which way is up, the mean of those that it stands for, what is read smaller, what is
 * missing or damaged; and files of meshes that name them. */
#include "acquire/picture.h"
#include "process/mesh-texture.h"
#include "tests/import-made.h"
#include <turbojpeg.h>

#define SIDE 256u

/* Red, green, blue and white quarters, from the upper left. */
static const uint8_t quarter[4][3] = { { 200, 20, 20 }, { 20, 200, 20 }, { 20, 20, 200 },
	{ 230, 230, 230 } };

static uint8_t *quarters(void)
{
	uint8_t *rgb = g_malloc_n(SIDE * SIDE, 3);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++)
			memcpy(rgb + 3 * (y * SIDE + x),
				quarter[2 * (y >= SIDE / 2) + (x >= SIDE / 2)], 3);
	return rgb;
}

/* Black and white, texel by texel. */
static uint8_t *checkered(void)
{
	uint8_t *rgb = g_malloc_n(SIDE * SIDE, 3);
	for (uint32_t y = 0; y < SIDE; y++)
		for (uint32_t x = 0; x < SIDE; x++)
			memset(rgb + 3 * (y * SIDE + x), (x + y) % 2 ? 255 : 0, 3);
	return rgb;
}

static char *write_png(const char *folder, const char *name, const uint8_t *rgb)
{
	g_autoptr(GError) error = NULL;
	char *path = g_build_filename(folder, name, NULL);
	g_autofree char *in = g_path_get_dirname(path);
	g_mkdir_with_parents(in, 0755);
	g_assert_true(picture_write(path, rgb, SIDE, SIDE, &error));
	g_assert_no_error(error);
	return path;
}

static char *write_jpeg(const char *folder, const char *name, const uint8_t *rgb)
{
	char *path = g_build_filename(folder, name, NULL);
	tjhandle writer = tjInitCompress();
	unsigned char *bytes = NULL;
	unsigned long length = 0;
	g_assert_cmpint(tjCompress2(writer, rgb, (int)SIDE, 0, (int)SIDE, TJPF_RGB, &bytes, &length,
				TJSAMP_444, 95, 0),
		==, 0);
	g_assert_true(g_file_set_contents(path, (const char *)bytes, (gssize)length, NULL));
	tjFree(bytes);
	tjDestroy(writer);
	return path;
}

/* One that tells of so many texels a side, with zeros behind it. */
static char *write_lying_jpeg(const char *folder, uint16_t side, int flags, gsize behind)
{
	char *path = g_build_filename(folder, "lying.jpg", NULL);
	static const uint8_t rgb[16 * 16 * 3];
	tjhandle writer = tjInitCompress();
	unsigned char *bytes = NULL, *size = NULL;
	unsigned long length = 0;
	g_assert_cmpint(tjCompress2(writer, rgb, 16, 0, 16, TJPF_RGB, &bytes, &length, TJSAMP_444,
				95, flags),
		==, 0);
	for (unsigned char *at = bytes; !size; at++)
		if (at[0] == 0xff && (at[1] == 0xc0 || at[1] == 0xc2))
			size = at + 5;
	size[0] = size[2] = (uint8_t)(side >> 8);
	size[1] = size[3] = (uint8_t)side;
	g_autofree char *all = g_malloc0(length + behind);
	memcpy(all, bytes, length);
	g_assert_true(g_file_set_contents(path, all, (gssize)(length + behind), NULL));
	tjFree(bytes);
	tjDestroy(writer);
	return path;
}

static int worst_of(const uint8_t a[3], const uint8_t b[3])
{
	int worst = 0;
	for (int i = 0; i < 3; i++)
		worst = MAX(worst, abs(a[i] - b[i]));
	return worst;
}

static mesh_texture *read_whole(const char *path)
{
	g_autoptr(GError) error = NULL;
	mesh_texture *t = mesh_texture_read(path, 1u << 24, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(mesh_texture_texels(t), ==, SIDE * SIDE);
	return t;
}

/* ---- texels ---- */

static void check_quarters(const mesh_texture *t, int most)
{
	for (int q = 0; q < 4; q++)
		for (int turn = -2; turn <= 2; turn++) {
			uint8_t rgb[3];
			double u = 0.25 + 0.5 * (q % 2), v = 0.75 - 0.5 * (q / 2);
			mesh_texture_at(t, u + turn, v - turn, 0, rgb);
			g_assert_cmpint(worst_of(rgb, quarter[q]), <=, most);
		}
}

static void test_which_way(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree uint8_t *rgb = quarters();
	g_autofree char *png = write_png(folder, "a.png", rgb),
			*jpeg = write_jpeg(folder, "a.jpg", rgb);
	g_autoptr(mesh_texture) one = read_whole(png), other = read_whole(jpeg);
	uint8_t between[3], nowhere[3];
	check_quarters(one, 0);
	check_quarters(other, 4);
	/* On the border of red and green half of each, and all of it the mean of all. */
	mesh_texture_at(one, 0.5, 0.75, 0, between);
	g_assert_cmpint(worst_of(between, (const uint8_t[]){ 110, 110, 20 }), <=, 1);
	mesh_texture_at(one, 0.3, 0.3, 1, between);
	g_assert_cmpint(worst_of(between, (const uint8_t[]){ 118, 118, 118 }), <=, 3);
	mesh_texture_at(one, NAN, INFINITY, NAN, nowhere);
	mesh_texture_at(one, 1e30, -1e30, 1e30, nowhere);
}

static void test_mean(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree uint8_t *rgb = checkered();
	g_autofree char *png = write_png(folder, "a.png", rgb);
	g_autoptr(mesh_texture) t = read_whole(png);
	uint8_t grey[3];
	for (int i = 0; i < 100; i++) {
		mesh_texture_at(t, i * 0.0137, i * 0.0071, 16.0 / (SIDE * SIDE), grey);
		g_assert_cmpint(worst_of(grey, (const uint8_t[]){ 128, 128, 128 }), <=, 1);
	}
	/* Of one texel alone there is no mean. */
	mesh_texture_at(t, 0.5 / SIDE, 1 - 0.5 / SIDE, 0, grey);
	g_assert_cmpuint(grey[0], ==, 0);
	mesh_texture_at(t, 1.5 / SIDE, 1 - 0.5 / SIDE, 0, grey);
	g_assert_cmpuint(grey[0], ==, 255);
}

static void test_smaller(void)
{
	g_autofree char *folder = simulated_folder();
	g_autofree uint8_t *rgb = quarters();
	g_autofree char *png = write_png(folder, "a.png", rgb),
			*jpeg = write_jpeg(folder, "a.jpg", rgb);
	for (int i = 0; i < 2; i++) {
		g_autoptr(GError) error = NULL;
		g_autoptr(mesh_texture) t = mesh_texture_read(i ? jpeg : png, 5000, &error);
		g_assert_no_error(error);
		g_assert_cmpuint(mesh_texture_texels(t), <=, 5000);
		g_assert_cmpuint(mesh_texture_texels(t), >=, 4096);
		check_quarters(t, 4);
	}
}

/* Cut and flipped files: a sentence with the path, or a picture. */
static void test_damage(void)
{
	g_autofree char *folder = simulated_folder(), *bytes = NULL;
	g_autofree uint8_t *rgb = quarters();
	g_autofree char *bad = g_build_filename(folder, "bad", NULL);
	for (int kind = 0; kind < 2; kind++) {
		g_autofree char *path =
			kind ? write_jpeg(folder, "a.jpg", rgb) : write_png(folder, "a.png", rgb);
		gsize length;
		unsigned refused = 0;
		g_clear_pointer(&bytes, g_free);
		g_assert_true(g_file_get_contents(path, &bytes, &length, NULL));
		for (gsize i = 0; i < length; i += MAX(length / 150, 1)) {
			g_autoptr(GError) error = NULL;
			g_autofree char *other = g_memdup2(bytes, length);
			other[i] = (char)(other[i] ^ 0x5a);
			g_file_set_contents(bad, other, (gssize)(i % 2 ? length : i), NULL);
			g_autoptr(mesh_texture) t = mesh_texture_read(bad, 1u << 24, &error);
			refused += !t;
			if (!t)
				g_assert_true(g_str_has_prefix(error->message, bad));
		}
		g_assert_cmpuint(refused, >, 10);
	}
}

static void refuse_lying(const char *folder, int flags, gsize behind, const char *words)
{
	g_autofree char *path = write_lying_jpeg(folder, 12000, flags, behind);
	g_autoptr(GError) error = NULL;
	g_assert_null(mesh_texture_read(path, 1u << 22, &error));
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA);
	g_assert_true(g_str_has_prefix(error->message, path));
	g_assert_true(g_str_has_suffix(error->message, words));
}

/* Of hardly any bytes there are not so many texels; and of several scans all would be in memory at once, however small it is read. */
static void test_lying(void)
{
	g_autofree char *folder = simulated_folder();
	g_autoptr(GError) error = NULL;
	refuse_lying(
		folder, 0, 0, "lying.jpg: is cut short: it has fewer bytes than its size needs");
	refuse_lying(folder, TJFLAG_PROGRESSIVE, 100000, "lying.jpg: is too large a picture");
	g_autofree char *path = write_lying_jpeg(folder, 12000, 0, 100000);
	g_autoptr(mesh_texture) t = mesh_texture_read(path, 1u << 22, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(mesh_texture_texels(t), ==, 1500 * 1500);
}

/* ---- meshes ---- */

/* A square of 2 x 2 m that shows the whole picture. */
static const char square[] =
	"mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nvt 0 0\nvt 1 0\nvt 1 1\n"
	"vt 0 1\nusemtl wall\nf 1/1 2/2 3/3 4/4\n";
static const char square_ply[] =
	"ply\nformat ascii 1.0\ncomment TextureFile quarters.png\nelement vertex 4\nproperty float "
	"x\n"
	"property float y\nproperty float z\nproperty float s\nproperty float t\nelement face 2\n"
	"property list uchar int vertex_indices\nend_header\n0 0 0 0 0\n2 0 0 1 0\n2 2 0 1 1\n"
	"0 2 0 0 1\n3 0 1 2\n3 0 2 3\n";

static points *import_square(
	struct place *p, const char *name, const char *text, GArray **ret_scans)
{
	g_autofree char *path = place_write(p, name, text, strlen(text));
	g_autoptr(GError) error = NULL;
	struct import_options options = { .mesh.spacing_m = 0.05 };
	*ret_scans = import_file(p->site, path, &options, &error);
	g_assert_no_error(error);
	return place_points(p, 1);
}

static void check_square(const points *all, const uint8_t wanted[4][3])
{
	uint64_t looked = 0;
	g_assert_true(all->have & POINTS_HAVE_COLOUR);
	for (uint64_t i = 0; i < all->count; i++) {
		const struct point_record *r = &all->record[i];
		if (fabs(r->x_m - 1) < 0.1 || fabs(r->y_m - 1) < 0.1 || fabs(r->x_m - 1) > 0.9 ||
			fabs(r->y_m - 1) > 0.9)
			continue;
		looked++;
		g_assert_cmpint(worst_of(r->rgb, wanted[2 * (r->y_m < 1) + (r->x_m > 1)]), <=, 2);
	}
	g_assert_cmpuint(looked, >, 500);
}

static const struct named {
	const char *name, *text, *material;
} named[] = {
	{ "a.obj", square, "newmtl wall\nKd 0.1 0.1 0.1\nmap_Kd pictures\\quarters.png\n" },
	{ "a.obj", square, "newmtl wall\nmap_Kd C:/Users/elsewhere/quarters.png\n" },
	{ "a.obj", square,
		"map_Kd early.png\nnewmtl wall\nKd nan 1 0\nmap_Bump no.png\n"
		"\tmap_Kd -s 1 1 1 -o 0 0 -mm 0 1 -clamp on quarters.png \r\n" },
	{ "a.ply", square_ply, NULL },
};

static void test_square(gconstpointer data)
{
	const struct named *n = data;
	struct place p = place_new();
	g_autofree uint8_t *rgb = quarters();
	bool below = n->material && strstr(n->material, "pictures");
	g_autofree char *picture =
		write_png(p.folder, below ? "pictures/quarters.png" : "quarters.png", rgb);
	g_autofree char *material =
		n->material ? place_write(&p, "a.mtl", n->material, strlen(n->material)) : NULL;
	g_autoptr(GArray) scans = NULL;
	g_autoptr(points) all = import_square(&p, n->name, n->text, &scans);
	check_square(all, quarter);
	g_assert_nonnull(picture);
	place_clear(&p);
}

/* Points further apart than the texels have their mean. */
static void test_fine_texture(void)
{
	static const char material_text[] = "newmtl wall\nmap_Kd fine.png\n";
	static const uint8_t grey[4][3] = { { 128, 128, 128 }, { 128, 128, 128 }, { 128, 128, 128 },
		{ 128, 128, 128 } };
	struct place p = place_new();
	g_autofree uint8_t *rgb = checkered();
	g_autofree char *picture = write_png(p.folder, "fine.png", rgb);
	g_autofree char *material = place_write(&p, "a.mtl", material_text, strlen(material_text));
	g_autoptr(GArray) scans = NULL;
	g_autoptr(points) all = import_square(&p, "a.obj", square, &scans);
	check_square(all, grey);
	g_assert_true(picture && material);
	place_clear(&p);
}

static void test_missing(void)
{
	static const char material_text[] = "newmtl wall\nKd 0.2 0.4 0.6\nmap_Kd lost.png\n";
	static const uint8_t blue[4][3] = { { 51, 102, 153 }, { 51, 102, 153 }, { 51, 102, 153 },
		{ 51, 102, 153 } };
	struct place p = place_new();
	g_autofree char *material = place_write(&p, "a.mtl", material_text, strlen(material_text));
	g_autoptr(GArray) scans = NULL;
	g_autoptr(points) all = import_square(&p, "a.obj", square, &scans);
	const char *note = g_array_index(scans, struct imported, 0).note;
	check_square(all, blue);
	g_assert_nonnull(strstr(note, "1 of its 1 textures could not be read"));
	g_assert_nonnull(strstr(note, "lost.png"));
	g_assert_nonnull(material);
	place_clear(&p);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	g_test_add_func("/mesh-texture/which-way", test_which_way);
	g_test_add_func("/mesh-texture/mean", test_mean);
	g_test_add_func("/mesh-texture/smaller", test_smaller);
	g_test_add_func("/mesh-texture/damage", test_damage);
	g_test_add_func("/mesh-texture/lying", test_lying);
	for (size_t i = 0; i < G_N_ELEMENTS(named); i++)
		commands_add("/mesh-texture/square", i, &named[i], test_square);
	g_test_add_func("/mesh-texture/fine", test_fine_texture);
	g_test_add_func("/mesh-texture/missing", test_missing);
	return g_test_run();
}
