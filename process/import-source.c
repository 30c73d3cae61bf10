#include "firmware-io/files.h"
#include "process/import.h"
#include <errno.h>
#include <gio/gio.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

struct import_source {
	char *path;
	int fd; /* -1: bytes at hand */
	const uint8_t *bytes;
	uint64_t size;
	int memory_fd; /* -1: none; the bytes again, as a file */
	char *fd_name;
};

import_source *import_source_open(const char *path, GError **error)
{
	size_t size;
	int fd = files_open_plain(path, &size, error);
	if (fd < 0)
		return NULL;
	import_source *s = g_new0(import_source, 1);
	s->path = g_strdup(path);
	s->fd = fd;
	s->memory_fd = -1;
	s->size = size;
	return s;
}

import_source *import_source_from_bytes(const void *bytes, size_t length, const char *name)
{
	import_source *s = g_new0(import_source, 1);
	s->path = g_strdup(name);
	s->fd = s->memory_fd = -1;
	s->bytes = bytes;
	s->size = length;
	return s;
}

void import_source_free(import_source *s)
{
	if (!s)
		return;
	if (s->fd >= 0)
		close(s->fd);
	if (s->memory_fd >= 0)
		close(s->memory_fd);
	g_free(s->fd_name);
	g_free(s->path);
	g_free(s);
}

const char *import_source_path(const import_source *s)
{
	return s->path;
}

bool import_source_is_file(const import_source *s)
{
	return s->fd >= 0;
}

uint64_t import_source_size(const import_source *s)
{
	return s->size;
}

bool import_source_read(import_source *s, uint64_t offset, void *into, size_t length,
	size_t *ret_got, GError **error)
{
	*ret_got = 0;
	length = (size_t)MIN(length, s->size - MIN(offset, s->size));
	if (s->fd < 0 && length) {
		memcpy(into, s->bytes + offset, length);
		*ret_got = length;
	}
	while (*ret_got < length) {
		ssize_t n = pread(s->fd, (char *)into + *ret_got, length - *ret_got,
			(off_t)(offset + *ret_got));
		if (n < 0 && errno != EINTR)
			return files_fail(error, s->path, "read");
		if (n == 0)
			break; /* it became shorter meanwhile */
		*ret_got += n > 0 ? (size_t)n : 0;
	}
	return true;
}

static bool copy_to_memory(import_source *s)
{
	s->memory_fd = memfd_create("import", MFD_CLOEXEC);
	uint64_t done = 0;
	while (s->memory_fd >= 0 && done < s->size) {
		ssize_t n = write(s->memory_fd, s->bytes + done, (size_t)(s->size - done));
		if (n < 0 && errno != EINTR)
			return false;
		done += n > 0 ? (uint64_t)n : 0;
	}
	return s->memory_fd >= 0;
}

const char *import_source_name_for_library(import_source *s, GError **error)
{
	if (s->fd_name)
		return s->fd_name;
	if (s->fd < 0 && !copy_to_memory(s)) {
		files_fail(error, s->path, "copy it in memory");
		return NULL;
	}
	/* Of the descriptor, not of the path, where another file may stand by now. */
	s->fd_name = g_strdup_printf("/proc/self/fd/%d", s->fd < 0 ? s->memory_fd : s->fd);
	return s->fd_name;
}

bool import_refuse(GError **error, const import_source *s, int code, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args),
			*plain = g_utf8_make_valid(what, -1);
	va_end(args);
	/* What libraries say has pieces of the file in it, and ends of lines. */
	for (char *c = plain; *c; c++)
		if (g_ascii_iscntrl(*c))
			*c = ' ';
	g_set_error(error, G_IO_ERROR, code, "%s: %s", s->path, plain);
	return false;
}
