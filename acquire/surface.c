#include "acquire/surface.h"
#include "firmware-io/files.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Fixed, so that it can be written when all is known, and records lie aligned. */
#define HEADER_BYTES 512

G_STATIC_ASSERT(sizeof(struct surface_record) == 32);

static void write_header(char into[HEADER_BYTES], uint64_t count)
{
	static const char end[] = "\nend_header\n";
	char text[HEADER_BYTES];
	int length = snprintf(text, sizeof text,
		"ply\nformat binary_little_endian 1.0\nelement vertex %" G_GUINT64_FORMAT
		"\nproperty float nx\nproperty float ny\nproperty float nz\n"
		"property float k1\nproperty float k2\n"
		"property float d1x\nproperty float d1y\nproperty float d1z\ncomment ",
		count);
	g_assert(length > 0 && (size_t)length + sizeof end < HEADER_BYTES);
	memset(into, '.', HEADER_BYTES);
	memcpy(into, text, (size_t)length);
	memcpy(into + HEADER_BYTES - (sizeof end - 1), end, sizeof end - 1);
}

scan_surface *surface_open(const char *path, uint64_t count, GError **error)
{
	size_t bytes;
	char header[HEADER_BYTES];
	int fd = files_open_plain(path, &bytes, error);
	if (fd < 0)
		return NULL;
	bool fits = count < UINT64_MAX / 64 &&
		    bytes == HEADER_BYTES + count * sizeof(struct surface_record);
	void *map = fits ? mmap(NULL, bytes, PROT_READ, MAP_PRIVATE, fd, 0) : MAP_FAILED;
	close(fd);
	write_header(header, count);
	if (map != MAP_FAILED && memcmp(map, header, HEADER_BYTES) == 0) {
		scan_surface *s = g_new(scan_surface, 1);
		*s = (scan_surface){
			(const struct surface_record *)((const char *)map + HEADER_BYTES), count
		};
		return s;
	}
	if (map != MAP_FAILED)
		munmap(map, bytes);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		"%s: is not of the %" G_GUINT64_FORMAT " points beside it", path, count);
	return NULL;
}

bool surface_open_of_scan(
	const site *s, uint32_t number, uint64_t count, scan_surface **ret, GError **error)
{
	g_autofree char *folder = site_scan_path(s, number),
			*path = g_build_filename(folder, "surface.ply", NULL);
	*ret = NULL;
	return !g_file_test(path, G_FILE_TEST_EXISTS) || (*ret = surface_open(path, count, error));
}

void surface_free(scan_surface *s)
{
	if (!s)
		return;
	munmap((char *)s->record - HEADER_BYTES, HEADER_BYTES + s->count * sizeof *s->record);
	g_free(s);
}

/* ---- writing ---- */

struct surface_writer {
	char *path;
	FILE *file;
	uint64_t count;
	bool finished;
};

surface_writer *surface_writer_new(const char *path, GError **error)
{
	char header[HEADER_BYTES] = { 0 };
	g_autoptr(surface_writer) w = g_new0(surface_writer, 1);
	w->path = g_strdup(path);
	w->file = fopen(path, "we");
	if (!w->file || fwrite(header, 1, sizeof header, w->file) != sizeof header) {
		files_fail(error, path, "write");
		return NULL;
	}
	return g_steal_pointer(&w);
}

bool surface_writer_append(
	surface_writer *w, const struct surface_record *records, size_t count, GError **error)
{
	w->count += count;
	return fwrite(records, sizeof *records, count, w->file) == count ||
	       files_fail(error, w->path, "write");
}

bool surface_writer_finish(surface_writer *w, GError **error)
{
	char header[HEADER_BYTES];
	write_header(header, w->count);
	bool good = fseek(w->file, 0, SEEK_SET) == 0 &&
		    fwrite(header, 1, sizeof header, w->file) == sizeof header;
	good = fclose(w->file) == 0 && good;
	w->file = NULL;
	w->finished = good;
	return good || files_fail(error, w->path, "write");
}

void surface_writer_free(surface_writer *w)
{
	if (!w)
		return;
	if (w->file)
		fclose(w->file);
	if (!w->finished)
		g_unlink(w->path);
	g_free(w->path);
	g_free(w);
}
