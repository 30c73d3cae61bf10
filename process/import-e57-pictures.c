/* Pictures that came with a scan of an E57 file: those that name it, and with its first scan those that name none. */
#include "firmware-io/files.h"
#include "process/import-e57.h"
#include "process/pose-json.h"
#include <errno.h>
#include <fcntl.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <string.h>
#include <unistd.h>

#define PIECE_BYTES (1u << 16)

static bool is_of_scan(const struct e57 *r, const struct e57_image *image)
{
	return image->scan == E57_NO_SCAN ? r->scans == 1 : image->scan == r->next - 1;
}

static bool check_blob(struct e57 *r, const struct e57_image *image, GError **error)
{
	uint8_t h[E57_BLOB_BYTES];
	if (!e57_pages_read(r->pages, image->section, h, sizeof h, error))
		return false;
	uint64_t length;
	memcpy(&length, h + 8,
		sizeof length); /* of the section; some writers leave its header out */
	if (h[0] != E57_BLOB_ID || GUINT64_FROM_LE(length) < image->bytes)
		return e57_pages_refuse(error, r->pages, image->section,
			"there is no picture of %" G_GUINT64_FORMAT " bytes here", image->bytes);
	return true;
}

static bool copy_bytes(
	struct e57 *r, const struct e57_image *image, int fd, const char *path, GError **error)
{
	g_autofree uint8_t *piece = g_malloc(PIECE_BYTES);
	uint64_t at = image->section + E57_BLOB_BYTES;
	for (uint64_t done = 0; done < image->bytes;) {
		size_t some = (size_t)MIN(PIECE_BYTES, image->bytes - done);
		if (!e57_pages_read(r->pages, at + done, piece, some, error))
			return false;
		for (size_t put = 0; put < some;) {
			ssize_t n = write(fd, piece + put, some - put);
			if (n < 0 && errno != EINTR)
				return files_fail(error, path, "write");
			put += n > 0 ? (size_t)n : 0;
		}
		done += some;
	}
	return true;
}

static bool copy_out(struct e57 *r, const struct e57_image *image, const char *path, GError **error)
{
	if (!check_blob(r, image, error))
		return false;
	int fd = open(path, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
	if (fd < 0)
		return files_fail(error, path, "be made");
	bool good = copy_bytes(r, image, fd, path, error);
	if (close(fd) && good)
		good = files_fail(error, path, "write");
	if (!good)
		g_unlink(path);
	return good;
}

static void set_number(JsonObject *o, const char *name, double value)
{
	if (value > 0)
		json_object_set_double_member(o, name, value);
}

static JsonObject *describe(const struct e57_image *image, const char *file)
{
	JsonObject *o = json_object_new();
	json_object_set_string_member(o, "file", file);
	if (image->name)
		json_object_set_string_member(o, "name", image->name);
	json_object_set_string_member(o, "kind", image->kind);
	if (image->width > 0 && image->height > 0) {
		json_object_set_int_member(o, "width", image->width);
		json_object_set_int_member(o, "height", image->height);
	}
	bool angles = strcmp(image->kind, "pinhole") != 0;
	set_number(o, angles ? "pixel_width_rad" : "pixel_width_m", image->pixel_width);
	set_number(o, angles ? "pixel_height_rad" : "pixel_height_m", image->pixel_height);
	set_number(o, "focal_m", image->focal_m);
	if (image->has_pose)
		json_object_set_member(o, "pose", json_write_pose(&image->pose));
	return o;
}

bool e57_save_pictures(import_reader *reader, const char *folder, JsonArray *into, GError **error)
{
	struct e57 *r = (struct e57 *)reader;
	for (guint i = 0; i < r->tree->images->len; i++) {
		const struct e57_image *image = r->tree->images->pdata[i];
		if (!is_of_scan(r, image))
			continue;
		g_autofree char *file = g_strdup_printf("picture-%02u.%s",
					json_array_get_length(into) + 1, image->extension),
				*path = g_build_filename(folder, file, NULL);
		g_autoptr(GError) why = NULL;
		if (copy_out(r, image, path, &why))
			json_array_add_object_element(into, describe(image, file));
		else if (g_error_matches(why, G_IO_ERROR, G_IO_ERROR_INVALID_DATA))
			e57_add_note(r, "picture %u was left out: %s", image->number, why->message);
		else
			return g_propagate_error(error, g_steal_pointer(&why)), false;
	}
	r->scan.note = r->notes->len ? r->notes->str : NULL;
	return true;
}
