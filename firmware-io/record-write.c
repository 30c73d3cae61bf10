#include "firmware-io/files.h"
#include "firmware-io/record-format.h"
#include "firmware-io/record.h"
#include <errno.h>
#include <fcntl.h>
#include <gio/gio.h>
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

/* The owner writes and counts; the syncing thread brings `synced` up to `written`, one fdatasync
 * for whatever came meanwhile. */
struct record_writer {
	char *path;
	int fd;
	uint64_t size;
	uint32_t sequence;
	GError *failure; /* the first; the file gets no more after it */

	pthread_t thread;
	bool thread_runs;
	pthread_mutex_t mutex; /* of what follows; never held while the disk is at work */
	pthread_cond_t changed;
	uint64_t written, synced;
	enum { GO_ON, FINISH, DROP } order;
	int sync_errno;
};

static bool nothing_to_sync(const record_writer *w)
{
	return w->written == w->synced && w->order == GO_ON;
}

static int sync_file(int fd)
{
	int result;
	while ((result = fdatasync(fd)) && errno == EINTR)
		;
	return result ? errno : 0;
}

/* Ends with the first error: the kernel forgets the pages that it could not write, so a second
 * fdatasync that succeeds would say nothing. */
static void *sync_without_end(void *data)
{
	record_writer *w = data;
	pthread_mutex_lock(&w->mutex);
	while (!w->sync_errno) {
		while (nothing_to_sync(w))
			pthread_cond_wait(&w->changed, &w->mutex);
		if (w->order == DROP || w->written == w->synced)
			break;
		uint64_t target = w->written;
		pthread_mutex_unlock(&w->mutex);
		int failed = sync_file(w->fd);
		pthread_mutex_lock(&w->mutex);
		w->sync_errno = failed;
		w->synced = failed ? w->synced : target;
	}
	pthread_mutex_unlock(&w->mutex);
	return NULL;
}

/* Signals are for the program's own threads. */
static int start_thread(record_writer *w)
{
	sigset_t all, before;
	sigfillset(&all);
	pthread_sigmask(SIG_SETMASK, &all, &before);
	int failed = pthread_create(&w->thread, NULL, sync_without_end, w);
	pthread_sigmask(SIG_SETMASK, &before, NULL);
	if (!failed)
		pthread_setname_np(w->thread, "record-sync");
	return failed;
}

static void stop_thread(record_writer *w, int order)
{
	if (!w->thread_runs)
		return;
	pthread_mutex_lock(&w->mutex);
	w->order = order;
	pthread_cond_signal(&w->changed);
	pthread_mutex_unlock(&w->mutex);
	pthread_join(w->thread, NULL);
	w->thread_runs = false;
}

static record_writer *writer_new(const char *path, uint64_t size, uint32_t sequence, GError **error)
{
	g_autoptr(record_writer) w = g_new0(record_writer, 1);
	w->path = g_strdup(path);
	w->size = w->written = w->synced = size;
	w->sequence = sequence;
	pthread_mutex_init(&w->mutex, NULL);
	pthread_cond_init(&w->changed, NULL);
	w->fd = open(path, O_WRONLY | O_CLOEXEC);
	if (w->fd < 0)
		return files_fail(error, path, "open for writing"), NULL;
	if ((errno = start_thread(w)))
		return files_fail(error, path, "start the thread that syncs"), NULL;
	w->thread_runs = true;
	return g_steal_pointer(&w);
}

void record_writer_free(record_writer *w)
{
	if (!w)
		return;
	stop_thread(w, DROP);
	if (w->fd >= 0)
		close(w->fd);
	pthread_cond_destroy(&w->changed);
	pthread_mutex_destroy(&w->mutex);
	g_clear_error(&w->failure);
	g_free(w->path);
	g_free(w);
}

record_writer *record_create(const char *path, GError **error)
{
	struct record_file_header h = { .version = GUINT32_TO_LE(RECORD_FILE_VERSION) };
	memcpy(h.magic, RECORD_FILE_MAGIC, sizeof h.magic);
	h.crc = GUINT32_TO_LE(record_file_header_crc(&h));
	if (!files_create(path, &h, sizeof h, error))
		return NULL;
	return writer_new(path, sizeof h, 0, error);
}

/* Where the whole entries end and what number comes next. */
static bool find_end(const char *path, uint64_t *ret_end, uint32_t *ret_sequence, uint64_t *ret_cut,
	GError **error)
{
	g_autoptr(record_reader) r = record_open(path, error);
	struct record_entry entry;
	enum record_result result = RECORD_BAD;
	if (!r)
		return false;
	uint32_t sequence = 0;
	while ((result = record_next(r, &entry, error)) == RECORD_ENTRY)
		sequence = entry.sequence + 1;
	if (result == RECORD_BAD)
		return false;
	*ret_end = record_reader_position(r);
	*ret_cut = record_reader_size(r) - *ret_end;
	*ret_sequence = sequence;
	return true;
}

record_writer *record_append_to(const char *path, uint64_t *ret_cut_bytes, GError **error)
{
	uint64_t end, cut;
	uint32_t sequence;
	if (!find_end(path, &end, &sequence, &cut, error))
		return NULL;
	g_autoptr(record_writer) w = writer_new(path, end, sequence, error);
	if (!w)
		return NULL;
	/* The shortened file must be on the disk before new entries are: else a power cut could
	 * leave these behind old remains. */
	if (cut && (ftruncate(w->fd, (off_t)end) || (errno = sync_file(w->fd))))
		return files_fail(error, path, "remove its cut end"), NULL;
	if (ret_cut_bytes)
		*ret_cut_bytes = cut;
	return g_steal_pointer(&w);
}

/* Goes on after what was written. */
static void advance(struct iovec *parts, size_t done)
{
	for (int i = 0; done; i++) {
		size_t here = MIN(parts[i].iov_len, done);
		if (!here)
			continue;
		parts[i].iov_base = (char *)parts[i].iov_base + here;
		parts[i].iov_len -= here;
		done -= here;
	}
}

/* Returns the bytes that did not fit, with errno; 0 when all did. Uses up parts. */
static size_t put(int fd, struct iovec *parts, int count, uint64_t offset)
{
	size_t left = 0;
	for (int i = 0; i < count; i++)
		left += parts[i].iov_len;
	while (left) {
		ssize_t n = pwritev(fd, parts, count, (off_t)offset);
		if (n < 0 && errno == EINTR)
			continue;
		if (n <= 0)
			return errno = n ? errno : EIO, left;
		advance(parts, (size_t)n);
		offset += (size_t)n;
		left -= (size_t)n;
	}
	return 0;
}

static void fail_write(record_writer *w, size_t missing, size_t whole)
{
	int cause = errno;
	if (cause == ENOSPC || cause == EDQUOT)
		g_set_error(&w->failure, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
			"%s: the disk is full: %zu of the %zu bytes of entry %u did not fit",
			w->path, missing, whole, w->sequence);
	else
		g_set_error(&w->failure, G_IO_ERROR, g_io_error_from_errno(cause),
			"%s: cannot write %zu of the %zu bytes of entry %u: %s", w->path, missing,
			whole, w->sequence, g_strerror(cause));
}

static void fail_sync(record_writer *w, int cause)
{
	g_set_error(&w->failure, G_IO_ERROR, g_io_error_from_errno(cause),
		"%s: the disk did not keep what was written: %s", w->path, g_strerror(cause));
}

static bool report(const record_writer *w, GError **error)
{
	if (w->failure)
		g_propagate_error(error, g_error_copy(w->failure));
	return !w->failure;
}

/* Tells the thread how far the file goes by now, and hears from it. */
static void hand_over(record_writer *w)
{
	pthread_mutex_lock(&w->mutex);
	w->written = w->size;
	int sync_errno = w->sync_errno;
	pthread_cond_signal(&w->changed);
	pthread_mutex_unlock(&w->mutex);
	if (sync_errno && !w->failure)
		fail_sync(w, sync_errno);
}

static struct record_head make_head(const record_writer *w, enum record_kind kind, int64_t time_ns,
	const struct iovec *part1, const struct iovec *part2)
{
	struct record_head h = {
		.mark = GUINT32_TO_LE(RECORD_ENTRY_MARK),
		.kind = GUINT32_TO_LE(kind),
		.length = GUINT32_TO_LE((uint32_t)(part1->iov_len + part2->iov_len)),
		.sequence = GUINT32_TO_LE(w->sequence),
		.time_ns = GUINT64_TO_LE((uint64_t)time_ns),
	};
	uint32_t crc = crc32c(record_head_crc(&h), part1->iov_base, part1->iov_len);
	h.crc = GUINT32_TO_LE(crc32c(crc, part2->iov_base, part2->iov_len));
	return h;
}

bool record_write(record_writer *w, enum record_kind kind, int64_t time_ns, const void *part1,
	size_t length1, const void *part2, size_t length2, GError **error)
{
	g_assert(kind > 0 && kind < RECORD_KINDS);
	if (w->failure)
		return report(w, error);
	if (length1 > RECORD_PAYLOAD_MAX || length2 > RECORD_PAYLOAD_MAX - length1) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_MESSAGE_TOO_LARGE,
			"%s: %zu + %zu bytes are too many for an entry", w->path, length1, length2);
		return false;
	}
	struct record_head head;
	uint64_t zeros = 0;
	struct iovec parts[] = {
		{ &head, sizeof head },
		{ (void *)part1, length1 },
		{ (void *)part2, length2 },
		{ &zeros, record_padding(length1 + length2) },
	};
	size_t whole = sizeof head + length1 + length2 + parts[3].iov_len;
	head = make_head(w, kind, time_ns, &parts[1], &parts[2]);
	size_t missing = put(w->fd, parts, G_N_ELEMENTS(parts), w->size);
	if (missing) {
		fail_write(w, missing, whole);
	} else {
		w->size += whole;
		w->sequence++;
		hand_over(w);
	}
	return report(w, error);
}

uint64_t record_writer_size(const record_writer *w)
{
	return w->size;
}

bool record_close(record_writer *w, GError **error)
{
	stop_thread(w, FINISH);
	if (w->sync_errno && !w->failure)
		fail_sync(w, w->sync_errno);
	int fd = w->fd;
	w->fd = -1;
	if (close(fd) && !w->failure)
		fail_sync(w, errno);
	bool ok = report(w, error);
	record_writer_free(w);
	return ok;
}
