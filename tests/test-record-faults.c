/* The record's writer on disks that are slow, full or failing, and when it is killed. */
#include "firmware-io/files.h"
#include "firmware-io/record.h"
#include "tests/known-entries.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <sched.h>
#include <stdatomic.h>
#include <sys/mount.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

enum { LONGEST = 20000, KILLS = 200 };

/* The disk that these tests have: it stands where the C library stands otherwise. */
static struct {
	bool short_writes; /* writes part of what is asked, or is interrupted */
	size_t room;       /* bytes until it is full; 0 = no end */
	atomic_int sync_errno, sync_ms, syncs;
} disk;

static ssize_t write_some(int fd, const struct iovec *parts, off_t offset, size_t most)
{
	for (; !parts->iov_len; parts++)
		;
	return pwrite(fd, parts->iov_base, MIN(parts->iov_len, most), offset);
}

ssize_t pwritev(int fd, const struct iovec *parts, int count, off_t offset)
{
	if (disk.room && (size_t)offset >= disk.room)
		return errno = ENOSPC, -1;
	if (disk.room)
		return write_some(fd, parts, offset, disk.room - (size_t)offset);
	if (!disk.short_writes)
		return syscall(SYS_pwritev, fd, parts, (long)count, (long)offset, 0L);
	if (g_test_rand_bit())
		return errno = EINTR, -1;
	return write_some(fd, parts, offset, (size_t)g_test_rand_int_range(1, LONGEST));
}

int fdatasync(int fd)
{
	disk.syncs++;
	if (disk.sync_ms)
		g_usleep(1000 * (gulong)disk.sync_ms);
	errno = disk.sync_errno;
	if (disk.sync_ms || errno)
		return errno ? -1 : 0;
	return (int)syscall(SYS_fdatasync, fd);
}

struct folder {
	char *path, *file;
	record_writer *w;
};

static void set_up(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	f->path = g_dir_make_tmp("record-XXXXXX", &error);
	f->file = g_build_filename(f->path, "raw.rec", NULL);
	f->w = record_create(f->file, &error);
	g_assert_no_error(error);
}

static void tear_down(struct folder *f, gconstpointer data)
{
	(void)data;
	record_writer_free(f->w);
	g_assert_true(files_remove_tree(f->path, NULL));
	g_free(f->file);
	g_free(f->path);
	disk.short_writes = false;
	disk.room = 0;
	disk.sync_errno = disk.sync_ms = disk.syncs = 0;
}

/* The record's end; whole entries are right and count up from 0. */
static enum record_result check_record(const char *path, uint32_t *ret_count)
{
	g_autoptr(GError) error = NULL;
	g_autoptr(record_reader) r = record_open(path, &error);
	g_assert_no_error(error);
	struct record_entry e;
	enum record_result result;
	*ret_count = 0;
	while ((result = record_next(r, &e, &error)) == RECORD_ENTRY) {
		g_assert_cmpuint(e.sequence, ==, (*ret_count)++);
		known_check(&e, LONGEST);
	}
	g_assert_no_error(error);
	return result;
}

static void test_short_writes(struct folder *f, gconstpointer data)
{
	(void)data;
	uint32_t count;
	disk.short_writes = true;
	for (uint32_t i = 0; i < 200; i++)
		g_assert_true(known_write(f->w, i, LONGEST, NULL));
	g_assert_true(record_close(g_steal_pointer(&f->w), NULL));
	g_assert_cmpint(check_record(f->file, &count), ==, RECORD_AT_END);
	g_assert_cmpuint(count, ==, 200);
}

static uint32_t write_until_error(record_writer *w, uint32_t number, GError **error)
{
	while (known_write(w, number, LONGEST, error))
		number++;
	return number;
}

/* With more room it goes on where it was. */
static void go_on(struct folder *f, uint32_t written)
{
	g_autoptr(GError) error = NULL;
	uint64_t cut;
	uint32_t count;
	f->w = record_append_to(f->file, &cut, &error);
	g_assert_no_error(error);
	g_assert_cmpuint(cut, >, 0);
	for (uint32_t i = written; i < written + 10; i++)
		g_assert_true(known_write(f->w, i, LONGEST, NULL));
	g_assert_true(record_close(g_steal_pointer(&f->w), &error));
	g_assert_cmpint(check_record(f->file, &count), ==, RECORD_AT_END);
	g_assert_cmpuint(count, ==, written + 10);
}

static void test_full(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL, again = NULL, at_close = NULL;
	disk.room = 100000;
	uint32_t written = write_until_error(f->w, 0, &error), count;
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE);
	struct known k = known_entry(written, LONGEST);
	uint64_t whole = 32 + (k.length + 7u) / 8 * 8;
	g_autofree char *sentence = g_strdup_printf(
		"%s: the disk is full: %u of the %u bytes of entry %u did not fit", f->file,
		(unsigned)(record_writer_size(f->w) + whole - disk.room), (unsigned)whole, written);
	g_free(k.payload);
	g_assert_cmpstr(error->message, ==, sentence);
	g_assert_false(known_write(f->w, written, LONGEST, &again));
	g_assert_cmpstr(again->message, ==, sentence);
	g_assert_false(record_close(g_steal_pointer(&f->w), &at_close));
	g_assert_cmpstr(at_close->message, ==, sentence);
	g_assert_cmpint(check_record(f->file, &count), ==, RECORD_CUT);
	g_assert_cmpuint(count, ==, written);
	disk.room = 0;
	go_on(f, written);
}

static void map_to_root(const char *path, unsigned id)
{
	int fd = open(path, O_WRONLY);
	dprintf(fd, "0 %u 1", id);
	close(fd);
}

/* Who is not root may mount as the root of a name space of its own. */
static bool mount_small_disk(const char *path)
{
	unsigned uid = geteuid(), gid = getegid();
	if (unshare(CLONE_NEWNS | (uid ? CLONE_NEWUSER : 0)))
		return false;
	if (uid) {
		map_to_root("/proc/self/uid_map", uid);
		int fd = open("/proc/self/setgroups", O_WRONLY);
		dprintf(fd, "deny");
		close(fd);
		map_to_root("/proc/self/gid_map", gid);
	}
	mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL);
	return mount("tmpfs", path, "tmpfs", 0, "size=1m") == 0;
}

/* In a process of its own, since the mount must not be seen outside. Exit status 77: not permitted.
 */
static void fill_small_disk(const struct folder *f)
{
	if (!mount_small_disk(f->path))
		_exit(77);
	g_autoptr(GError) error = NULL;
	record_writer *w = record_create(f->file, NULL);
	uint32_t written = write_until_error(w, 0, &error), count;
	g_assert_error(error, G_IO_ERROR, G_IO_ERROR_NO_SPACE);
	g_assert_false(record_close(w, NULL));
	check_record(f->file, &count);
	g_assert_cmpuint(count, ==, written);
	_exit(0);
}

static void test_really_full(struct folder *f, gconstpointer data)
{
	(void)data;
	int status;
	g_clear_pointer(&f->w, record_writer_free);
	pid_t child = fork();
	if (child == 0)
		fill_small_disk(f);
	g_assert_cmpint(waitpid(child, &status, 0), ==, child);
	if (WIFEXITED(status) && WEXITSTATUS(status) == 77)
		g_test_skip("no permission to mount a small disk");
	else
		g_assert_cmpint(status, ==, 0);
}

static void test_failing(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL, at_close = NULL;
	uint32_t number = 0;
	disk.sync_errno = EIO;
	for (; !error && number < 5000; g_usleep(1000))
		known_write(f->w, number++, 100, &error);
	g_assert_nonnull(error);
	g_assert_true(strstr(error->message, "raw.rec: the disk did not keep what was written"));
	g_assert_cmpint(disk.syncs, ==, 1);
	disk.sync_errno = 0;
	g_assert_false(known_write(f->w, number, 100, NULL));
	g_assert_false(record_close(g_steal_pointer(&f->w), &at_close));
	g_assert_cmpstr(at_close->message, ==, error->message);
}

static void test_failing_at_close(struct folder *f, gconstpointer data)
{
	(void)data;
	g_autoptr(GError) error = NULL;
	disk.sync_ms = 20;
	disk.sync_errno = EIO;
	g_assert_true(known_write(f->w, 0, 100, &error));
	g_assert_false(record_close(g_steal_pointer(&f->w), &error));
	g_assert_nonnull(error);
}

/* Writing does not wait for the disk, closing does; one sync is for all that came meanwhile, and
 * none for nothing. */
static void test_slow(struct folder *f, gconstpointer data)
{
	(void)data;
	disk.sync_ms = 50;
	int64_t start_us = g_get_monotonic_time();
	for (uint32_t i = 0; i < 50; i++) {
		g_assert_true(known_write(f->w, i, 100, NULL));
		g_usleep(2000);
	}
	g_assert_cmpint(disk.syncs, <=, 2 + (g_get_monotonic_time() - start_us) / 50000);
	g_usleep(300000);
	int syncs = disk.syncs;
	g_assert_cmpint(syncs, >=, 2);
	g_usleep(100000);
	g_assert_cmpint(disk.syncs, ==, syncs);
	g_assert_true(known_write(f->w, 50, 100, NULL));
	g_assert_true(record_close(g_steal_pointer(&f->w), NULL));
	g_assert_cmpint(disk.syncs, ==, syncs + 1);
}

/* No wake-up is lost: each entry alone comes to the disk without a nudge from the next. */
static void test_each_is_synced(struct folder *f, gconstpointer data)
{
	(void)data;
	for (uint32_t i = 0; i < 100; i++) {
		int before = disk.syncs;
		g_assert_true(known_write(f->w, i, 100, NULL));
		for (int ms = 0; disk.syncs == before && ms < 5000; ms++)
			g_usleep(1000);
		g_assert_cmpint(disk.syncs, >, before);
	}
}

/* A child goes on with the record until it is killed. */
static void write_until_killed(const char *path, uint32_t number)
{
	alarm(60); /* should the parent end first */
	record_writer *w = record_append_to(path, NULL, NULL);
	for (int i = 0; w && i < 300; i++)
		if (!known_write(w, number++, LONGEST, NULL))
			_exit(1);
	pause();
	_exit(1);
}

static void kill_soon(pid_t child)
{
	int status;
	g_usleep((gulong)g_test_rand_int_range(0, 8000));
	kill(child, SIGKILL);
	g_assert_cmpint(waitpid(child, &status, 0), ==, child);
	g_assert_true(WIFSIGNALED(status));
}

static void test_kills(struct folder *f, gconstpointer data)
{
	(void)data;
	uint32_t count = 0, before = 0, total = 0, cuts = 0;
	g_clear_pointer(&f->w, record_writer_free);
	for (int i = 0; i < KILLS; i++, before = count) {
		if (i % 8 == 0) { /* from the start, so that the files stay small */
			g_remove(f->file);
			record_writer_free(record_create(f->file, NULL));
			before = 0;
		}
		pid_t child = fork();
		if (child == 0)
			write_until_killed(f->file, before);
		kill_soon(child);
		cuts += check_record(f->file, &count) == RECORD_CUT;
		g_assert_cmpuint(count, >=, before);
		total += count - before;
	}
	g_test_message("%u entries by %d killed writers, %u cut", total, KILLS, cuts);
	g_assert_cmpuint(total, >, 0);
}

/* Stopped in the middle of an entry, at every eighth part of it. */
static void test_stopped_inside(struct folder *f, gconstpointer data)
{
	(void)data;
	for (uint32_t i = 0; i < 8; i++)
		g_assert_true(known_write(f->w, i, LONGEST, NULL));
	uint64_t whole = record_writer_size(f->w);
	g_assert_true(known_write(f->w, 8, LONGEST, NULL));
	uint64_t more = record_writer_size(f->w);
	g_assert_true(record_close(g_steal_pointer(&f->w), NULL));
	for (uint64_t part = 7; part; part--) {
		g_assert_cmpint(
			truncate(f->file, (off_t)(whole + (more - whole) * part / 8)), ==, 0);
		uint32_t count;
		g_assert_cmpint(check_record(f->file, &count), ==, RECORD_CUT);
		g_assert_cmpuint(count, ==, 8);
	}
	go_on(f, 8);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
#define ADD(name, test)                                                                            \
	g_test_add("/record-faults/" name, struct folder, NULL, set_up, test, tear_down)
	ADD("short-writes", test_short_writes);
	ADD("full", test_full);
	ADD("really-full", test_really_full);
	ADD("failing", test_failing);
	ADD("failing-at-close", test_failing_at_close);
	ADD("slow", test_slow);
	ADD("each-is-synced", test_each_is_synced);
	ADD("kills", test_kills);
	ADD("stopped-inside", test_stopped_inside);
	return g_test_run();
}
