/* The panorama of a station as others show it: all around, azimuth across and elevation down in equal steps. In the middle is the
 * direction of x, to its left that of y; what the station did not see is black. */
#include "acquire/picture.h"
#include "firmware-io/files.h"
#include "process/export-e57.h"
#include <math.h>
#include <string.h>

#define WIDTH_MAX 8192
/* A grid beyond is not loaded into memory for a picture. */
#define CELLS_MAX         (16u << 20)
#define PICTURE_BYTES_MAX (512u << 20)

/* ---- the panorama ---- */

static void paint_row(
	const range_grid *g, uint8_t *rgb, uint32_t width, uint32_t height, uint32_t y)
{
	double step = 2 * G_PI / width, elevation = (height / 2.0 - y - 0.5) * step;
	for (uint32_t x = 0; x < width; x++) {
		double azimuth = (width / 2.0 - x - 0.5) * step;
		uint32_t cell = range_grid_find(g, cos(elevation) * cos(azimuth),
			cos(elevation) * sin(azimuth), sin(elevation));
		if (cell != RANGE_GRID_NONE)
			memcpy(rgb + 3 * ((size_t)y * width + x), g->rgb + 3 * (size_t)cell, 3);
	}
}

static uint32_t width_of(const range_grid *g)
{
	double width = 2 * G_PI / fmax(g->column_rad, 1e-6);
	return (uint32_t)CLAMP(width, 256, WIDTH_MAX) / 2 * 2;
}

static bool write_panorama(const struct export_station *s, const range_grid *g, e57_write *to,
	e57_xml *x, const char *guid)
{
	uint32_t width = width_of(g), height = width / 2;
	g_autofree uint8_t *rgb = g_malloc0(3 * (size_t)width * height);
	for (uint32_t y = 0; y < height; y++)
		paint_row(g, rgb, width, height, y);
	g_autoptr(GBytes) png = picture_png(rgb, width, height);
	if (!png)
		return false;
	g_autofree char *name = g_strdup_printf("%s panorama", s->name);
	size_t length = g_bytes_get_size(png);
	struct e57_xml_picture p = { .name = name,
		.kind = "spherical",
		.guid = (char *)guid,
		.is_png = true,
		.bytes = length,
		.has_pose = s->has_pose,
		.pose = s->pose,
		.width = width,
		.height = height,
		.pixel_width = 2 * G_PI / width,
		.pixel_height = 2 * G_PI / width };
	p.offset = e57_write_blob(to, g_bytes_get_data(png, NULL), length);
	e57_xml_picture(x, s, &p);
	return true;
}

static bool add_panorama(const struct export_job *j, const struct export_station *s, e57_write *to,
	e57_xml *x, GError **error)
{
	if (!s->columns || s->cells > CELLS_MAX || !s->survey.has_colour)
		return true;
	g_autoptr(scan_data) d = scan_data_load(j->site, s->number, error);
	g_autofree char *guid = export_guid(j, s->number, "panorama");
	if (!d)
		return false;
	if (d->grid->rgb && !write_panorama(s, d->grid, to, x, guid))
		g_ptr_array_add(j->notes,
			g_strdup_printf("the panorama of scan %u is not in the file: no memory",
				s->number));
	return true;
}

/* ---- those that came with an imported station ---- */

static bool is_known_kind(const char *kind)
{
	static const char *const kinds[] = { "spherical", "pinhole", "cylindrical",
		"visual reference", NULL };
	return kind && g_strv_contains(kinds, kind);
}

static bool add_picture(const struct export_job *j, const struct export_station *s,
	const struct export_picture *from, guint number, e57_write *to, e57_xml *x, GError **error)
{
	size_t length;
	g_autofree char *bytes = files_read(from->path, PICTURE_BYTES_MAX, &length, error),
			*what = g_strdup_printf("picture %u", number),
			*guid = export_guid(j, s->number, what);
	if (!bytes)
		return false;
	struct e57_xml_picture p = { .name = from->name,
		.kind = from->kind,
		.guid = guid,
		.is_png = g_str_has_suffix(from->path, ".png"),
		.bytes = length,
		.has_pose = from->has_pose,
		.pose = from->pose,
		.width = from->width,
		.height = from->height,
		.pixel_width = from->pixel_width,
		.pixel_height = from->pixel_height,
		.focal_m = from->focal_m };
	p.offset = e57_write_blob(to, bytes, length);
	e57_xml_picture(x, s, &p);
	return true;
}

bool export_e57_pictures(const struct export_job *j, const struct export_station *s, e57_write *to,
	e57_xml *x, GError **error)
{
	bool has_sphere = false;
	for (guint i = 0; i < s->pictures->len; i++) {
		const struct export_picture *p = s->pictures->pdata[i];
		has_sphere |= g_strcmp0(p->kind, "spherical") == 0;
		if (is_known_kind(p->kind) && !add_picture(j, s, p, i, to, x, error))
			return false;
	}
	/* What came is better than what can be made of the points. */
	return has_sphere || add_panorama(j, s, to, x, error);
}
