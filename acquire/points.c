#include "acquire/points.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <stdio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

/* Fixed, so that it can be written when all is known, and records lie aligned. */
#define HEADER_BYTES 512

G_STATIC_ASSERT(sizeof(struct point_record) == 32);
G_STATIC_ASSERT(G_BYTE_ORDER == G_LITTLE_ENDIAN); /* records are mapped as they lie in the file */

static bool refuse(GError **error, const char *path, const char *format, ...) G_GNUC_PRINTF(3, 4);

static bool refuse(GError **error, const char *path, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, "%s: %s", path, what);
	return false;
}

/* ---- the header ---- */

static const char properties[] = "property double x\nproperty double y\nproperty double z\n"
				 "property ushort intensity\n"
				 "property uchar red\nproperty uchar green\nproperty uchar blue\n"
				 "property uchar classification\nproperty uchar cell\n"
				 "property uchar return_number\n";

static void write_header(char into[HEADER_BYTES], const struct points *p)
{
	static const char end[] = "\nend_header\n";
	char text[HEADER_BYTES];
	int length = snprintf(text, sizeof text,
		"ply\nformat binary_little_endian 1.0\n"
		"obj_info num_cols %u\nobj_info num_rows %u\nobj_info have %u\n"
		"element vertex %" G_GUINT64_FORMAT "\n%scomment ",
		p->columns, p->rows, p->have, p->count, properties);
	g_assert(length > 0 && (size_t)length + sizeof end < HEADER_BYTES);
	memset(into, '.', HEADER_BYTES);
	memcpy(into, text, (size_t)length);
	memcpy(into + HEADER_BYTES - (sizeof end - 1), end, sizeof end - 1);
}

/* There is one way to write a header: what reads differently is none of ours. */
static bool read_header(const char *bytes, struct points *ret)
{
	char text[HEADER_BYTES + 1] = { 0 }, again[HEADER_BYTES];
	memcpy(text, bytes, HEADER_BYTES);
	if (sscanf(text,
		    "ply\nformat binary_little_endian 1.0\nobj_info num_cols %u\nobj_info num_rows "
		    "%u\nobj_info have %u\nelement vertex %" G_GUINT64_FORMAT,
		    &ret->columns, &ret->rows, &ret->have, &ret->count) != 4)
		return false;
	write_header(again, ret);
	return memcmp(bytes, again, HEADER_BYTES) == 0;
}

/* ---- reading ---- */

static bool check(const struct points *p, uint64_t bytes, const char *path, GError **error)
{
	uint64_t there = (bytes - HEADER_BYTES) / sizeof(struct point_record);
	if (p->count > (UINT64_MAX >> 8) || bytes != HEADER_BYTES + p->count * sizeof *p->record)
		return refuse(error, path,
			"its header tells of %" G_GUINT64_FORMAT
			" points, and there are %" G_GUINT64_FORMAT,
			p->count, there);
	if ((!p->columns != !p->rows) || (p->columns && (uint64_t)p->columns * p->rows != p->count))
		return refuse(error, path,
			"its header tells of a grid of %u x %u with %" G_GUINT64_FORMAT " points",
			p->columns, p->rows, p->count);
	return true;
}

points *points_open(const char *path, GError **error)
{
	size_t bytes;
	int fd = files_open_plain(path, &bytes, error);
	if (fd < 0)
		return NULL;
	void *map = bytes >= HEADER_BYTES ? mmap(NULL, bytes, PROT_READ, MAP_PRIVATE, fd, 0)
					  : MAP_FAILED;
	if (map == MAP_FAILED && bytes >= HEADER_BYTES)
		files_fail(error, path, "map");
	close(fd);
	points *p = g_new0(points, 1);
	if (map != MAP_FAILED && read_header(map, p) && check(p, bytes, path, error)) {
		p->record = (const struct point_record *)((const char *)map + HEADER_BYTES);
		return p;
	}
	if (map != MAP_FAILED)
		munmap(map, bytes);
	g_free(p);
	if (!error || !*error)
		refuse(error, path, "does not begin as points.ply does");
	return NULL;
}

void points_free(points *p)
{
	if (!p)
		return;
	munmap((char *)p->record - HEADER_BYTES, HEADER_BYTES + p->count * sizeof *p->record);
	g_free(p);
}

void points_forget(const points *p, uint64_t first, uint64_t count)
{
	uintptr_t page = (uintptr_t)sysconf(_SC_PAGESIZE);
	uintptr_t from = ((uintptr_t)(p->record + first) + page - 1) / page * page,
		  to = (uintptr_t)(p->record + first + count) / page * page;
	if (to > from)
		madvise((void *)from, to - from, MADV_DONTNEED);
}

/* ---- writing ---- */

struct points_writer {
	char *path, *beside; /* beside: under which it is written; NULL when it is finished */
	int fd;
	struct points p;
};

points_writer *points_writer_new(const char *path, uint32_t columns, uint32_t rows, GError **error)
{
	points_writer *w = g_new0(points_writer, 1);
	w->path = g_strdup(path);
	w->beside = g_strconcat(path, ".new", NULL);
	w->p.columns = columns;
	w->p.rows = rows;
	w->fd = open(w->beside, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
	if (w->fd >= 0 && lseek(w->fd, HEADER_BYTES, SEEK_SET) == HEADER_BYTES)
		return w;
	files_fail(error, path, "write");
	points_writer_free(w);
	return NULL;
}

static bool write_all(int fd, const void *bytes, size_t length)
{
	while (length) {
		ssize_t n = write(fd, bytes, length);
		if (n < 0 && errno != EINTR)
			return false;
		bytes = (const char *)bytes + MAX(n, 0);
		length -= (size_t)MAX(n, 0);
	}
	return true;
}

static uint32_t have(const struct point_record *records, size_t count)
{
	uint32_t intensity = 0, colour = 0, classification = 0;
	for (size_t i = 0; i < count; i++) {
		intensity |= records[i].intensity;
		colour |= records[i].rgb[0] | records[i].rgb[1] | records[i].rgb[2];
		classification |= records[i].classification;
	}
	return (intensity ? POINTS_HAVE_INTENSITY : 0) | (colour ? POINTS_HAVE_COLOUR : 0) |
	       (classification ? POINTS_HAVE_CLASSIFICATION : 0);
}

bool points_writer_append(
	points_writer *w, const struct point_record *records, size_t count, GError **error)
{
	w->p.have |= have(records, count);
	w->p.count += count;
	return write_all(w->fd, records, count * sizeof *records) ||
	       files_fail(error, w->path, "write");
}

bool points_writer_finish(points_writer *w, GError **error)
{
	char header[HEADER_BYTES];
	uint64_t cells = (uint64_t)w->p.columns * w->p.rows;
	if (w->p.columns && w->p.count != cells)
		return refuse(error, w->path,
			"a grid of %u x %u has %" G_GUINT64_FORMAT " cells, not %" G_GUINT64_FORMAT,
			w->p.columns, w->p.rows, cells, w->p.count);
	write_header(header, &w->p);
	int fd = w->fd;
	bool written = lseek(fd, 0, SEEK_SET) == 0 && write_all(fd, header, sizeof header);
	w->fd = -1;
	if (close(fd) || !written || rename(w->beside, w->path))
		return files_fail(error, w->path, "write");
	g_clear_pointer(&w->beside, g_free);
	return true;
}

void points_writer_free(points_writer *w)
{
	if (!w)
		return;
	if (w->fd >= 0)
		close(w->fd);
	if (w->beside)
		unlink(w->beside);
	g_free(w->beside);
	g_free(w->path);
	g_free(w);
}
