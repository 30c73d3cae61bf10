#include "firmware-io/inbox.h"
#include <errno.h>
#include <string.h>
#include <sys/eventfd.h>
#include <time.h>
#include <unistd.h>

/* A piece is what came at once: of USB up to a transfer, of a serial line a few bytes. */
#define BYTES_PER_PIECE 16

struct piece {
	int64_t arrival_ns;
	uint32_t length, taken;
};

struct inbox {
	GMutex lock; /* of all below */
	uint8_t *bytes;
	struct piece *pieces;
	uint32_t room, pieces_room;
	uint32_t first, used;          /* of bytes, a ring */
	uint32_t first_piece, waiting; /* of pieces, likewise */
	GError *error;
	struct wire_counts counts;
	int fd;
	bool signalled;
};

int64_t inbox_now_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

inbox *inbox_new(uint32_t room)
{
	inbox *i = g_new0(inbox, 1);
	g_mutex_init(&i->lock);
	i->room = room;
	i->pieces_room = MAX(room / BYTES_PER_PIECE, 2);
	i->bytes = g_malloc0(room);
	i->pieces = g_new0(struct piece, i->pieces_room);
	i->counts.room = room;
	i->fd = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
	return i;
}

void inbox_free(inbox *i)
{
	if (!i)
		return;
	if (i->fd >= 0)
		close(i->fd);
	g_clear_error(&i->error);
	g_mutex_clear(&i->lock);
	g_free(i->bytes);
	g_free(i->pieces);
	g_free(i);
}

/* Under the lock, as all that follows up to the functions of the header. */
static void signal_owner(inbox *i)
{
	uint64_t one = 1;
	if (!i->signalled)
		i->signalled = write(i->fd, &one, sizeof one) == sizeof one;
}

static void quiet_down(inbox *i)
{
	uint64_t any;
	if (i->signalled && i->waiting == 0 && !i->error)
		i->signalled = read(i->fd, &any, sizeof any) != sizeof any;
}

static void copy_in(inbox *i, const uint8_t *bytes, uint32_t length)
{
	uint32_t at = (i->first + i->used) % i->room, before_end = MIN(length, i->room - at);
	memcpy(i->bytes + at, bytes, before_end);
	memcpy(i->bytes, bytes + before_end, length - before_end);
	i->used += length;
}

static void copy_out(inbox *i, uint8_t *bytes, uint32_t length)
{
	uint32_t before_end = MIN(length, i->room - i->first);
	memcpy(bytes, i->bytes + i->first, before_end);
	memcpy(bytes + before_end, i->bytes, length - before_end);
	i->first = (i->first + length) % i->room;
	i->used -= length;
}

void inbox_put(inbox *i, const void *bytes, size_t length, int64_t arrival_ns)
{
	if (length == 0)
		return;
	g_mutex_lock(&i->lock);
	i->counts.bytes += length;
	if (length > i->room - i->used || i->waiting == i->pieces_room) {
		i->counts.lost_bytes += length;
	} else {
		copy_in(i, bytes, (uint32_t)length);
		i->pieces[(i->first_piece + i->waiting++) % i->pieces_room] =
			(struct piece){ arrival_ns, (uint32_t)length, 0 };
		i->counts.waiting_most = MAX(i->counts.waiting_most, i->used);
	}
	signal_owner(i);
	g_mutex_unlock(&i->lock);
}

void inbox_fail(inbox *i, GError *error)
{
	g_mutex_lock(&i->lock);
	if (i->error)
		g_error_free(error);
	else
		i->error = error;
	signal_owner(i);
	g_mutex_unlock(&i->lock);
}

static gssize take_piece(inbox *i, void *bytes, size_t size, int64_t *ret_arrival_ns)
{
	struct piece *p = &i->pieces[i->first_piece];
	uint32_t n = (uint32_t)MIN(size, p->length - p->taken);
	copy_out(i, bytes, n);
	*ret_arrival_ns = p->arrival_ns;
	p->taken += n;
	if (p->taken == p->length) {
		i->first_piece = (i->first_piece + 1) % i->pieces_room;
		i->waiting--;
	}
	return n;
}

gssize inbox_take(inbox *i, void *bytes, size_t size, int64_t *ret_arrival_ns, GError **error)
{
	gssize n = 0;
	g_mutex_lock(&i->lock);
	if (i->waiting) {
		n = take_piece(i, bytes, size, ret_arrival_ns);
	} else if (i->error) {
		g_propagate_error(error, g_error_copy(i->error));
		n = -1;
	}
	quiet_down(i);
	g_mutex_unlock(&i->lock);
	return n;
}

void inbox_clear(inbox *i)
{
	g_mutex_lock(&i->lock);
	g_clear_error(&i->error);
	i->first = i->used = i->first_piece = i->waiting = 0;
	i->counts = (struct wire_counts){ .room = i->room };
	quiet_down(i);
	g_mutex_unlock(&i->lock);
}

int inbox_fd(const inbox *i)
{
	return i->fd;
}

void inbox_count(inbox *i, struct wire_counts *ret)
{
	g_mutex_lock(&i->lock);
	ret->bytes = i->counts.bytes;
	ret->lost_bytes = i->counts.lost_bytes;
	ret->waiting_most = i->counts.waiting_most;
	ret->room = i->counts.room;
	g_mutex_unlock(&i->lock);
}
