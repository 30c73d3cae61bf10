#include "process/copy-file.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#define BLOCK (1u << 20)

static bool write_all(int fd, const guint8 *at, size_t n, const char *path, GError **error)
{
	while (n) {
		ssize_t done = write(fd, at, n);
		if (done < 0 && errno != EINTR)
			return files_fail(error, path, "be written");
		at += MAX(done, 0);
		n -= (size_t)MAX(done, 0);
	}
	return true;
}

/* From one to the other (below 0: nowhere), with what it hashes to. */
static char *pump_bytes(int from, const char *from_path, int to, const char *to_path,
	const struct copy_watcher *w, GError **error)
{
	g_autoptr(GChecksum) sum = g_checksum_new(G_CHECKSUM_SHA256);
	g_autofree guint8 *block = g_malloc(BLOCK);
	ssize_t n;
	while ((n = read(from, block, BLOCK)) != 0) {
		if (n < 0 && errno == EINTR)
			continue;
		if (n < 0) {
			files_fail(error, from_path, "be read");
			return NULL;
		}
		g_checksum_update(sum, block, n);
		if (to >= 0 && !write_all(to, block, (size_t)n, to_path, error))
			return NULL;
		if (!w->goes_on((uint64_t)n, w->user_data)) {
			g_set_error_literal(error, G_IO_ERROR, G_IO_ERROR_CANCELLED,
				"stopped: what was copied so far is whole");
			return NULL;
		}
	}
	return g_strdup(g_checksum_get_string(sum));
}

char *copy_file_hash(const char *path, const struct copy_watcher *w, GError **error)
{
	int fd = files_open_plain(path, NULL, error);
	if (fd < 0)
		return NULL;
	posix_fadvise(fd, 0, 0, POSIX_FADV_SEQUENTIAL);
	char *hash = pump_bytes(fd, path, -1, NULL, w, error);
	close(fd);
	return hash;
}

/* NULL, and nothing is left. */
static char *write_part(
	const char *from, const char *part, const struct copy_watcher *w, GError **error)
{
	int in = files_open_plain(from, NULL, error), out;
	if (in < 0)
		return NULL;
	out = open(part, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, 0666);
	if (out < 0)
		files_fail(error, part, "be made");
	char *hash = out < 0 ? NULL : pump_bytes(in, from, out, part, w, error);
	close(in);
	if (hash && fsync(out)) {
		files_fail(error, part, "be written");
		g_clear_pointer(&hash, g_free);
	}
	if (out >= 0) {
		/* So that the comparison reads the drive and not memory. */
		posix_fadvise(out, 0, 0, POSIX_FADV_DONTNEED);
		close(out);
	}
	return hash;
}

char *copy_file(const char *from, const char *to, const struct copy_watcher *w, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(to), *name = g_path_get_basename(to);
	g_autofree char *hidden = g_strconcat(".", name, ".part", NULL);
	g_autofree char *part = g_build_filename(folder, hidden, NULL);
	g_autofree char *hash = write_part(from, part, w, error);
	g_autofree char *there = hash ? copy_file_hash(part, w, error) : NULL;
	bool good = there && !strcmp(hash, there);
	if (there && !good)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED,
			"%s: what the drive gives back is not what was written: the drive is "
			"broken",
			to);
	if (good && rename(part, to))
		good = files_fail(error, to, "be written");
	if (good)
		good = files_sync_folder(folder, error);
	if (good)
		return g_steal_pointer(&hash);
	unlink(part);
	return NULL;
}
