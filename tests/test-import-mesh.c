/* Meshes into a site: points lie on their triangles, normals and curvatures are those of the shapes, blue noise keeps its distance and
 * leaves no holes; files that lie are refused with their place, and the site is as it was. */
#include "acquire/surface.h"
#include "process/mesh-sample.h"
#include "process/model.h"
#include "process/scan-features.h"
#include "process/scan-geometry.h"
#include "tests/import-made.h"
#include "tests/support.h"

/* ---- shapes ---- */

/* Columns around, rows along: a torus of these radii, around z, or with tube 0 a cylinder of that radius from 0 to its height. */
struct shape {
	double radius_m, tube_m, height_m;
	uint32_t around, along;
};
static const struct shape torus = { 2, 0.5, 0, 120, 60 }, cylinder = { 0.75, 0, 3, 160, 40 };

static void place_of(const struct shape *s, uint32_t column, uint32_t row, double ret_m[3])
{
	double a = 2 * G_PI * column / s->around, b = 2 * G_PI * row / s->along;
	double level = s->tube_m > 0 ? s->radius_m + s->tube_m * cos(b) : s->radius_m;
	ret_m[0] = level * cos(a);
	ret_m[1] = level * sin(a);
	ret_m[2] = s->tube_m > 0 ? s->tube_m * sin(b) : s->height_m * row / (s->along - 1);
}

static uint32_t vertex_of(const struct shape *s, uint32_t column, uint32_t row)
{
	return row % s->along * s->around + column % s->around;
}

/* The two triangles of a cell of the shape's own grid. */
static void triangles_of(const struct shape *s, uint32_t column, uint32_t row, uint32_t ret[2][3])
{
	uint32_t v[4] = { vertex_of(s, column, row), vertex_of(s, column + 1, row),
		vertex_of(s, column + 1, row + 1), vertex_of(s, column, row + 1) };
	memcpy(ret[0], (uint32_t[]){ v[0], v[1], v[2] }, sizeof ret[0]);
	memcpy(ret[1], (uint32_t[]){ v[0], v[2], v[3] }, sizeof ret[1]);
}

static uint32_t rows_of(const struct shape *s)
{
	return s->tube_m > 0 ? s->along : s->along - 1;
}

static void add_vertices(GString *t, const struct shape *s, const char *before, const char *behind)
{
	for (uint32_t r = 0; r < s->along; r++)
		for (uint32_t c = 0; c < s->around; c++) {
			double at_m[3];
			place_of(s, c, r, at_m);
			g_string_append_printf(t, "%s%.7f %.7f %.7f%s\n", before, at_m[0], at_m[1],
				at_m[2], behind);
		}
}

static void add_faces(GString *t, const struct shape *s, const char *before, uint32_t first)
{
	for (uint32_t r = 0; r < rows_of(s); r++)
		for (uint32_t c = 0; c < s->around; c++) {
			uint32_t two[2][3];
			triangles_of(s, c, r, two);
			for (int k = 0; k < 2; k++)
				g_string_append_printf(t, "%s%u %u %u\n", before, two[k][0] + first,
					two[k][1] + first, two[k][2] + first);
		}
}

static GString *off_of(const struct shape *s, bool colour)
{
	GString *t = g_string_new(colour ? "COFF\n# made\n" : "OFF\n");
	g_string_append_printf(t, "%u %u 0\n", s->around * s->along, 2 * rows_of(s) * s->around);
	add_vertices(t, s, "", colour ? " 0.2 0.4 0.6 1" : "");
	add_faces(t, s, "3 ", 0);
	return t;
}

static GString *obj_of(const struct shape *s)
{
	GString *t = g_string_new("# made\nmtllib made.mtl\no shape\nusemtl red\n");
	add_vertices(t, s, "v ", "");
	add_faces(t, s, "f ", 1);
	return t;
}

static GString *ply_of(const struct shape *s)
{
	GString *t = g_string_new("ply\nformat ascii 1.0\n");
	g_string_append_printf(t,
		"element vertex %u\nproperty float x\nproperty float y\nproperty float z\n"
		"property uchar red\nproperty uchar green\nproperty uchar blue\n"
		"element face %u\nproperty list uchar int vertex_indices\nend_header\n",
		s->around * s->along, 2 * rows_of(s) * s->around);
	add_vertices(t, s, "", " 51 102 153");
	add_faces(t, s, "3 ", 0);
	return t;
}

static void add_stl_triangle(GString *t, const struct shape *s, const uint32_t v[3], bool text)
{
	float numbers[12] = { 0, 0, 1 };
	for (int k = 0; k < 3; k++) {
		double at_m[3];
		place_of(s, v[k] % s->around, v[k] / s->around, at_m);
		for (int i = 0; i < 3; i++)
			numbers[3 + 3 * k + i] = (float)at_m[i];
	}
	if (text) {
		g_string_append(t, "facet normal 0 0 1\nouter loop\n");
		for (int k = 1; k < 4; k++)
			g_string_append_printf(t, "vertex %.7f %.7f %.7f\n", (double)numbers[3 * k],
				(double)numbers[3 * k + 1], (double)numbers[3 * k + 2]);
		g_string_append(t, "endloop\nendfacet\n");
	} else {
		g_string_append_len(t, (const char *)numbers, sizeof numbers);
		g_string_append_len(t, "\0\0", 2);
	}
}

static GString *stl_of(const struct shape *s, bool text)
{
	GString *t = g_string_new(text ? "solid made\n" : NULL);
	uint32_t count = 2 * rows_of(s) * s->around;
	char header[80] = "made";
	if (!text) {
		g_string_append_len(t, header, sizeof header);
		g_string_append_len(t, (const char *)&count, sizeof count);
	}
	for (uint32_t r = 0; r < rows_of(s); r++)
		for (uint32_t c = 0; c < s->around; c++) {
			uint32_t two[2][3];
			triangles_of(s, c, r, two);
			add_stl_triangle(t, s, two[0], text);
			add_stl_triangle(t, s, two[1], text);
		}
	if (text)
		g_string_append(t, "endsolid made\n");
	return t;
}

/* ---- imported ---- */

struct sampled {
	struct place p;
	points *points;
	scan_surface *surface;
};

static struct sampled sample_file(
	const char *name, const GString *text, const struct import_mesh_options *how)
{
	struct sampled s = { .p = place_new() };
	g_autoptr(GError) error = NULL;
	g_autofree char *path = place_write(&s.p, name, text->str, text->len);
	struct import_options options = { .mesh = *how };
	g_autoptr(GArray) scans = import_file(s.p.site, path, &options, &error);
	g_assert_no_error(error);
	s.points = place_points(&s.p, 1);
	g_assert_true(surface_open_of_scan(s.p.site, 1, s.points->count, &s.surface, &error));
	g_assert_no_error(error);
	g_assert_nonnull(s.surface);
	return s;
}

static void sampled_clear(struct sampled *s)
{
	points_free(s->points);
	surface_free(s->surface);
	place_clear(&s->p);
}

static void at_of(const struct sampled *s, uint64_t i, double ret[3])
{
	const struct point_record *r = &s->points->record[i];
	ret[0] = r->x_m;
	ret[1] = r->y_m;
	ret[2] = r->z_m;
}

static double angle_deg(const float a[3], const double b[3], bool sign_free)
{
	double dot = 0, aa = 0, bb = 0;
	for (int i = 0; i < 3; i++) {
		dot += a[i] * b[i];
		aa += (double)a[i] * a[i];
		bb += b[i] * b[i];
	}
	double cosine = dot / sqrt(aa * bb);
	return acos(CLAMP(sign_free ? fabs(cosine) : cosine, -1, 1)) * 180 / G_PI;
}

/* What is true of the torus at its point: outwards, and the curvatures of the tube and around. */
static void torus_truth(
	const double at[3], double normal[3], double *tube, double *around, double along[3])
{
	double level = hypot(at[0], at[1]),
	       ring[3] = { at[0] / level * torus.radius_m, at[1] / level * torus.radius_m, 0 };
	double length = 0;
	for (int i = 0; i < 3; i++) {
		normal[i] = at[i] - ring[i];
		length += normal[i] * normal[i];
	}
	for (int i = 0; i < 3; i++)
		normal[i] /= sqrt(length);
	*tube = 1 / torus.tube_m;
	double outwards = (normal[0] * at[0] + normal[1] * at[1]) / level;
	*around = outwards / level;
	/* The tube's own circle lies across the way around. */
	double way[3] = { -at[1] / level, at[0] / level, 0 };
	along[0] = way[1] * normal[2];
	along[1] = -way[0] * normal[2];
	along[2] = way[0] * normal[1] - way[1] * normal[0];
}

static void assert_torus(const struct sampled *s, const uint8_t rgb[3])
{
	g_assert_cmpuint(s->points->count, >, 10000);
	for (uint64_t i = 0; i < s->points->count; i++) {
		const struct surface_record *r = &s->surface->record[i];
		double at[3], normal[3], tube, around, along[3];
		at_of(s, i, at);
		torus_truth(at, normal, &tube, &around, along);
		double level = hypot(at[0], at[1]) - torus.radius_m;
		/* Chords of the triangles lie inside. */
		g_assert_cmpfloat(fabs(hypot(level, at[2]) - torus.tube_m), <, 0.005);
		g_assert_cmpfloat(angle_deg(r->normal, normal, false), <, 3);
		g_assert_cmpfloat(fabs(r->k1 - tube), <, 0.1 * tube);
		g_assert_cmpfloat(fabs(r->k2 - around), <, 0.1 * tube);
		g_assert_cmpfloat(angle_deg(r->direction, along, true), <, 6);
		g_assert_cmpmem(s->points->record[i].rgb, 3, rgb, 3);
	}
}

static const char *const kinds[] = { "off", "coff", "obj", "ply", "stl", "stl-binary" };

static void test_kind(gconstpointer data)
{
	const char *kind = data;
	static const uint8_t none[3] = { 0 }, blue[3] = { 51, 102, 153 };
	bool colour = !strcmp(kind, "coff") || !strcmp(kind, "ply");
	GString *text = !strcmp(kind, "obj")            ? obj_of(&torus)
			: !strcmp(kind, "ply")          ? ply_of(&torus)
			: g_str_has_prefix(kind, "stl") ? stl_of(&torus, !strcmp(kind, "stl"))
							: off_of(&torus, colour);
	g_autofree char *name = g_strdup_printf("made.%.3s", kind[0] == 'c' ? "off" : kind);
	struct import_mesh_options how = { .points = 20000 };
	struct sampled s = sample_file(name, text, &how);
	assert_torus(&s, colour ? blue : none);
	sampled_clear(&s);
	g_string_free(text, true);
}

static void assert_told(const struct import_mesh_options *how, const char *words)
{
	g_autoptr(GString) text = off_of(&cylinder, false);
	struct sampled s = sample_file("made.off", text, how);
	g_autoptr(manifest) m = place_manifest(&s.p, 1);
	const char *note = json_node_get_string(manifest_get_node(m, "source.note"));
	g_assert_true(g_str_has_suffix(note, words));
	sampled_clear(&s);
}

static void test_what_is_told(void)
{
	assert_told(&(struct import_mesh_options){ .spacing_m = 0.25 }, " sampled 250 mm apart");
	assert_told(&(struct import_mesh_options){ .spacing_m = 1.25, .metres_a_unit = 10 },
		" sampled 1.25 m apart");
	assert_told(&(struct import_mesh_options){ .points = 50, .uniform = true }, " by chance");
}

/* Curved one way alone. */
static void test_cylinder(void)
{
	g_autoptr(GString) text = off_of(&cylinder, false);
	struct import_mesh_options how = { .spacing_m = 0.02 };
	struct sampled s = sample_file("made.off", text, &how);
	static const double up[3] = { 0, 0, 1 };
	for (uint64_t i = 0; i < s.points->count; i++) {
		const struct surface_record *r = &s.surface->record[i];
		double at[3], normal[3];
		at_of(&s, i, at);
		/* At the rims there is nothing beyond to compare with. */
		if (at[2] < 0.1 || at[2] > cylinder.height_m - 0.1)
			continue;
		memcpy(normal, (double[]){ at[0], at[1], 0 }, sizeof normal);
		g_assert_cmpfloat(angle_deg(r->normal, normal, false), <, 2);
		g_assert_cmpfloat(
			fabs(fabs(r->k1) - 1 / cylinder.radius_m), <, 0.05 / cylinder.radius_m);
		g_assert_cmpfloat(fabs(r->k2), <, 0.05);
		g_assert_cmpfloat(90 - angle_deg(r->direction, up, true), <, 3);
	}
	sampled_clear(&s);
}

/* Blue noise: none too near, and no place of the surface far from all of them. */
static void test_blue_noise(void)
{
	const double spacing_m = 0.08;
	g_autoptr(GString) text = off_of(&torus, false);
	struct import_mesh_options how = { .spacing_m = spacing_m },
				   dense = { .points = 20000, .uniform = true };
	struct sampled s = sample_file("made.off", text, &how),
		       all = sample_file("made.off", text, &dense);
	g_assert_cmpuint(s.points->count, >, 2000);
	for (uint64_t i = 0; i < s.points->count; i++)
		for (uint64_t k = 0; k < i; k++) {
			double a[3], b[3];
			at_of(&s, i, a);
			at_of(&s, k, b);
			g_assert_cmpfloat(hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]), >=,
				spacing_m * 0.9999);
		}
	double farthest = 0;
	for (uint64_t i = 0; i < all.points->count; i += 7) {
		double a[3], nearest = INFINITY;
		at_of(&all, i, a);
		for (uint64_t k = 0; k < s.points->count; k++) {
			double b[3];
			at_of(&s, k, b);
			nearest =
				fmin(nearest, hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]));
		}
		farthest = fmax(farthest, nearest);
	}
	g_test_message("no place is further than %.2f spacings from a point", farthest / spacing_m);
	g_assert_cmpfloat(farthest, <, 1.5 * spacing_m);
	sampled_clear(&s);
	sampled_clear(&all);
}

/* By chance: of equal areas equal shares, within what chance does; and about as many as were asked for. */
static void test_uniform(void)
{
	g_autoptr(GString) text = off_of(&cylinder, false);
	struct import_mesh_options how = { .points = 100000, .uniform = true };
	struct sampled s = sample_file("made.off", text, &how);
	unsigned cells[30][12] = { 0 };
	double chi_square = 0, mean = 100000 / 360.0;
	g_assert_cmpuint(s.points->count, ==, 100000);
	for (uint64_t i = 0; i < s.points->count; i++) {
		double at[3];
		at_of(&s, i, at);
		double turn = atan2(at[1], at[0]) / (2 * G_PI) + 0.5;
		cells[MIN((int)(at[2] / cylinder.height_m * 30), 29)][MIN((int)(turn * 12), 11)]++;
	}
	for (int r = 0; r < 30; r++)
		for (int c = 0; c < 12; c++)
			chi_square += (cells[r][c] - mean) * (cells[r][c] - mean) / mean;
	/* 359 degrees of freedom: beyond once in 100,000. Facets are not quite of the cells' own width. */
	g_assert_cmpfloat(chi_square, <, 359 + 4.3 * sqrt(2 * 359) + 40);
	sampled_clear(&s);
}

static void test_same(void)
{
	g_autoptr(GString) text = ply_of(&torus);
	struct import_mesh_options how = { .points = 5000 };
	struct sampled a = sample_file("made.ply", text, &how),
		       b = sample_file("made.ply", text, &how);
	g_assert_cmpuint(a.points->count, ==, b.points->count);
	/* About as many as were asked for. */
	g_assert_cmpuint(a.points->count, >, 4500);
	g_assert_cmpuint(a.points->count, <, 5500);
	g_assert_cmpmem(a.points->record, a.points->count * sizeof *a.points->record,
		b.points->record, b.points->count * sizeof *b.points->record);
	g_assert_cmpmem(a.surface->record, a.surface->count * sizeof *a.surface->record,
		b.surface->record, b.surface->count * sizeof *b.surface->record);
	sampled_clear(&a);
	sampled_clear(&b);
}

/* Millimetres, and y looks up. */
static void test_units(void)
{
	static const char text[] = "OFF\n4 2 0\n0 1000 0\n2000 1000 0\n2000 1000 -500\n0 1000 "
				   "-500\n3 0 1 2\n3 0 2 3\n";
	g_autoptr(GString) t = g_string_new(text);
	struct import_mesh_options how = { .points = 1000, .metres_a_unit = 0.001, .y_up = true };
	struct sampled s = sample_file("made.off", t, &how);
	for (uint64_t i = 0; i < s.points->count; i++) {
		double at[3];
		static const double up[3] = { 0, 0, 1 };
		at_of(&s, i, at);
		g_assert_cmpfloat(fabs(at[2] - 1), <, 1e-9);
		g_assert_true(at[0] >= 0 && at[0] <= 2 && at[1] >= 0 && at[1] <= 0.5);
		g_assert_cmpfloat(angle_deg(s.surface->record[i].normal, up, false), <, 0.01);
		g_assert_cmpfloat(fabs(s.surface->record[i].k1), <, 1e-6);
	}
	sampled_clear(&s);
}

/* Its materials lie beside it. */
static void test_material(void)
{
	struct place p = place_new();
	g_autoptr(GString) text = obj_of(&cylinder);
	static const char material[] = "newmtl red\nKd 1 0.2 0\n";
	g_autofree char *beside = place_write(&p, "made.mtl", material, strlen(material)),
			*path = place_write(&p, "made.obj", text->str, text->len);
	g_autoptr(GArray) scans = place_import(&p, path);
	g_autoptr(points) all = place_points(&p, 1);
	static const uint8_t red[3] = { 255, 51, 0 };
	g_assert_cmpmem(all->record[0].rgb, 3, red, 3);
	g_assert_null(strstr(g_array_index(scans, struct imported, 0).note, "materials"));
	g_assert_nonnull(beside);
	place_clear(&p);
}

/* Geometry and features take what the file told. */
static void test_products(void)
{
	struct place p = place_new();
	g_autoptr(GString) text = off_of(&torus, false);
	g_autofree char *path = place_write(&p, "made.off", text->str, text->len);
	struct import_options options = { .mesh.points = 20000 };
	g_autoptr(GError) error = NULL;
	GArray *scans = import_file(p.site, path, &options, &error);
	g_assert_no_error(error);
	g_array_unref(scans);
	site_free(p.site);
	g_auto(answer) a = commands_run("process", p.site_path);
	commands_assert_done(&a);
	p.site = site_open_for_writing(p.site_path, &error);
	g_assert_no_error(error);
	g_autoptr(points) all = place_points(&p, 1);
	g_autoptr(scan_surface) s = NULL;
	g_autoptr(scan_geometry) g = scan_geometry_open(p.site, 1, &error);
	g_autoptr(scan_features) f = scan_features_open(p.site, 1, &error);
	g_assert_no_error(error);
	g_assert_true(surface_open_of_scan(p.site, 1, all->count, &s, &error));
	for (uint64_t i = 0; i < all->count; i++) {
		float normal[3];
		model_unpack_normal(g->normal[i], normal);
		double wanted[3] = { s->record[i].normal[0], s->record[i].normal[1],
			s->record[i].normal[2] };
		g_assert_cmpfloat(angle_deg(normal, wanted, false), <, 0.05);
		g_assert_cmpfloat(f->k1[i], ==, s->record[i].k1);
		g_assert_cmpfloat(f->k2[i], ==, s->record[i].k2);
	}
	place_clear(&p);
}

/* ---- bad ones ---- */

static const struct bad {
	const char *name, *text, *words;
} bads[] = {
	{ "a.off", "OFF\n3 1 0\n0.00000 0.00000 0.00000\n1 0 0\n",
		"line 5: the file ends, and a vertex must stand here" },
	{ "b.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n",
		"line 6: there is no vertex 3: there are 3" },
	{ "c.off", "OFF\n4000000000 1 0\n0 0 0\n",
		"line 2: 4000000000 vertices and 1 faces cannot stand" },
	{ "d.off", "OFF\n3 1 0\n0 0 0\n1 x 0\n0 1 0\n3 0 1 2\n", "line 4: a vertex is x y z" },
	{ "e.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n", "its triangles have no area" },
	{ "f.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1\n",
		"line 6: a face of 3 corners has fewer" },
	{ "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n",
		"line 4: there is no vertex 4: the file has 3" },
	{ "b.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", "line 3: a face has three corners or more, not 2" },
	{ "c.obj", "v 0 0 0\nv 1 0\nf 1 2 3\n", "line 2: 3 numbers must stand behind v" },
	{ "d.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1 2/1 3/1\n",
		"line 4: there is no texture coordinate 1" },
	{ "a.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n",
		"line 5: the file ends here, and endsolid" },
	{ "b.stl", "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n",
		"line 4: 'vertex x y z' must stand here" },
	{ "c.stl", "not anything", "in its header, at byte 12" },
	{ "a.ply",
		"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
		"y\nproperty float z\n"
		"element face 1000000\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n",
		"a.ply" },
};

static void test_bad(gconstpointer data)
{
	const struct bad *b = data;
	struct place p = place_new();
	g_autofree char *path = place_write(&p, b->name, b->text, strlen(b->text));
	place_assert_refused(&p, path, G_IO_ERROR_INVALID_DATA, b->words);
	place_clear(&p);
}

static void test_cut(void)
{
	struct place p = place_new();
	g_autoptr(GString) text = stl_of(&cylinder, false);
	g_autofree char *path = place_write(&p, "cut.stl", text->str, text->len / 2);
	place_assert_refused(
		&p, path, G_IO_ERROR_INVALID_DATA, "byte 80: it tells of 12480 triangles");
	place_clear(&p);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	commands_find_programs();
	for (gsize i = 0; i < G_N_ELEMENTS(kinds); i++)
		commands_add("/import-mesh/kind", i, kinds[i], test_kind);
	for (gsize i = 0; i < G_N_ELEMENTS(bads); i++)
		commands_add("/import-mesh/bad", i, &bads[i], test_bad);
	g_test_add_func("/import-mesh/cylinder", test_cylinder);
	g_test_add_func("/import-mesh/what-is-told", test_what_is_told);
	g_test_add_func("/import-mesh/blue-noise", test_blue_noise);
	g_test_add_func("/import-mesh/uniform", test_uniform);
	g_test_add_func("/import-mesh/same", test_same);
	g_test_add_func("/import-mesh/units", test_units);
	g_test_add_func("/import-mesh/material", test_material);
	g_test_add_func("/import-mesh/products", test_products);
	g_test_add_func("/import-mesh/cut", test_cut);
	return g_test_run();
}
