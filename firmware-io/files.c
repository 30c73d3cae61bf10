#include "firmware-io/files.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define DEPTH_MAX 100 /* of folders to remove: each holds a descriptor open */

G_DEFINE_AUTOPTR_CLEANUP_FUNC(DIR, closedir)

bool files_fail(GError **error, const char *path, const char *what)
{
	int cause = errno;
	g_set_error(error, G_IO_ERROR, g_io_error_from_errno(cause), "%s: cannot %s: %s", path,
		what, g_strerror(cause));
	return false;
}

bool files_sync_folder(const char *path, GError **error)
{
	int fd = open(path, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
	if (fd < 0)
		return files_fail(error, path, "open the folder");
	/* EINVAL: a file system that has nothing to sync in a folder. */
	bool ok = fsync(fd) == 0 || errno == EINVAL || files_fail(error, path, "sync the folder");
	close(fd);
	return ok;
}

static bool sync_parent(const char *path, GError **error)
{
	/* "oak/" is in ".", not in "oak". */
	g_autofree char *whole = g_canonicalize_filename(path, NULL);
	g_autofree char *parent = g_path_get_dirname(whole);
	return files_sync_folder(parent, error);
}

/* Not every file system can refuse by itself to rename onto something. With one writer the check
 * before does as well. */
static int rename_no_replace(const char *from, const char *to)
{
	if (renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0)
		return 0;
	if (errno != EINVAL && errno != ENOSYS)
		return -1;
	struct stat there;
	if (lstat(to, &there) == 0)
		return errno = EEXIST, -1;
	return rename(from, to);
}

bool files_rename_new(const char *from, const char *to, GError **error)
{
	if (rename_no_replace(from, to) == 0)
		return sync_parent(to, error);
	if (errno != EEXIST)
		return files_fail(error, from, "rename it");
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_EXISTS, "%s: exists already", to);
	return false;
}

static bool write_and_sync(int fd, const char *bytes, size_t length)
{
	while (length) {
		ssize_t n = write(fd, bytes, length);
		if (n < 0 && errno != EINTR)
			return false;
		bytes += n > 0 ? n : 0;
		length -= n > 0 ? (size_t)n : 0;
	}
	return fsync(fd) == 0;
}

static char *path_beside(const char *path)
{
	g_autofree char *folder = g_path_get_dirname(path), *name = g_path_get_basename(path);
	g_autofree char *beside = g_strdup_printf(".%s.new", name);
	return g_build_filename(folder, beside, NULL);
}

/* The whole file under its other name, on the disk; caller frees the name. */
static char *write_beside(const char *path, const void *bytes, size_t length, GError **error)
{
	g_autofree char *beside = path_beside(path);
	int fd = open(beside, O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
	if (fd < 0)
		return files_fail(error, path, "write"), NULL;
	bool ok = write_and_sync(fd, bytes, length) || files_fail(error, path, "write");
	if (close(fd) && ok)
		ok = files_fail(error, path, "write");
	if (!ok)
		unlink(beside);
	return ok ? g_steal_pointer(&beside) : NULL;
}

bool files_write(const char *path, const void *bytes, size_t length, GError **error)
{
	g_autofree char *beside = write_beside(path, bytes, length, error);
	if (!beside)
		return false;
	if (rename(beside, path) == 0)
		return sync_parent(path, error);
	files_fail(error, path, "write");
	unlink(beside);
	return false;
}

bool files_create(const char *path, const void *bytes, size_t length, GError **error)
{
	g_autofree char *beside = write_beside(path, bytes, length, error);
	if (!beside)
		return false;
	if (files_rename_new(beside, path, error))
		return true;
	unlink(beside);
	return false;
}

int files_open_plain(const char *path, size_t *ret_size, GError **error)
{
	/* Without O_NONBLOCK a pipe of that name would hold us until someone writes to it. */
	int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
	struct stat st;
	if (fd < 0 || fstat(fd, &st)) {
		files_fail(error, path, "open");
	} else if (!S_ISREG(st.st_mode)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_REGULAR_FILE, "%s: is %s", path,
			S_ISDIR(st.st_mode) ? "a folder" : "not a plain file");
	} else {
		if (ret_size)
			*ret_size = (size_t)st.st_size;
		return fd;
	}
	if (fd >= 0)
		close(fd);
	return -1;
}

static bool read_all(int fd, char *into, size_t length, size_t *ret_got)
{
	for (*ret_got = 0; *ret_got < length;) {
		ssize_t n = read(fd, into + *ret_got, length - *ret_got);
		if (n < 0 && errno != EINTR)
			return false;
		if (n == 0)
			break;
		*ret_got += n > 0 ? (size_t)n : 0;
	}
	return true;
}

char *files_read(const char *path, size_t max, size_t *ret_length, GError **error)
{
	size_t size;
	int fd = files_open_plain(path, &size, error);
	if (fd < 0)
		return NULL;
	g_autofree char *text = NULL;
	bool ok = size <= max;
	if (!ok) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_MESSAGE_TOO_LARGE,
			"%s: has %zu bytes; at most %zu are read", path, size, max);
	} else {
		text = g_malloc0(size + 1);
		ok = read_all(fd, text, size, ret_length) || files_fail(error, path, "read");
	}
	close(fd);
	return ok ? g_steal_pointer(&text) : NULL;
}

bool files_make_folder(const char *path, GError **error)
{
	if (mkdir(path, 0777) == 0)
		return sync_parent(path, error);
	return errno == EEXIST || files_fail(error, path, "make the folder");
}

static int by_name(gconstpointer a, gconstpointer b)
{
	return strcmp(*(char *const *)a, *(char *const *)b);
}

GPtrArray *files_names(const char *path, GError **error)
{
	g_autoptr(DIR) dir = opendir(path);
	if (!dir)
		return files_fail(error, path, "open the folder"), NULL;
	g_autoptr(GPtrArray) names = g_ptr_array_new_with_free_func(g_free);
	struct dirent *entry;
	while (errno = 0, (entry = readdir(dir)))
		if (strcmp(entry->d_name, ".") && strcmp(entry->d_name, ".."))
			g_ptr_array_add(names, g_strdup(entry->d_name));
	if (errno)
		return files_fail(error, path, "read the folder"), NULL;
	g_ptr_array_sort(names, by_name);
	return g_steal_pointer(&names);
}

static bool remove_at(int folder, const char *name, int depth);

static bool remove_all_in(int folder, const char *name, int depth)
{
	int fd = openat(folder, name, O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
	if (fd < 0)
		return errno = errno == ENOTDIR ? EPERM : errno, false; /* a file that may not go */
	g_autoptr(DIR) dir = fdopendir(fd);
	if (!dir)
		return close(fd), false;
	struct dirent *entry;
	while (errno = 0, (entry = readdir(dir))) {
		if (!strcmp(entry->d_name, ".") || !strcmp(entry->d_name, ".."))
			continue;
		if (!remove_at(fd, entry->d_name, depth + 1))
			return false;
	}
	return errno == 0;
}

static bool remove_at(int folder, const char *name, int depth)
{
	if (unlinkat(folder, name, 0) == 0 || errno == ENOENT)
		return true;
	if (errno != EISDIR && errno != EPERM)
		return false;
	if (depth > DEPTH_MAX)
		return errno = ELOOP, false;
	return remove_all_in(folder, name, depth) && unlinkat(folder, name, AT_REMOVEDIR) == 0;
}

bool files_remove_tree(const char *path, GError **error)
{
	if (!remove_at(AT_FDCWD, path, 0))
		return files_fail(error, path, "remove");
	return sync_parent(path, error);
}
