#include "sim/outbox.h"

struct outbox {
	GArray *messages; /* struct outbox_message, sorted: a handful at most */
};

void outbox_message_clear(struct outbox_message *message)
{
	g_clear_pointer(&message->payload, g_byte_array_unref);
}

outbox *outbox_new(void)
{
	outbox *o = g_new0(outbox, 1);

	o->messages = g_array_new(FALSE, FALSE, sizeof(struct outbox_message));
	return o;
}

void outbox_free(outbox *o)
{
	if (!o)
		return;
	for (guint i = 0; i < o->messages->len; i++)
		outbox_message_clear(&g_array_index(o->messages, struct outbox_message, i));
	g_array_unref(o->messages);
	g_free(o);
}

void outbox_push(outbox *o, int64_t due_ns, enum link_kind kind, GByteArray *payload)
{
	struct outbox_message message = { due_ns, kind, payload };
	guint at = o->messages->len;

	while (at > 0 && g_array_index(o->messages, struct outbox_message, at - 1).due_ns > due_ns)
		at--;
	g_array_insert_val(o->messages, at, message);
}

int64_t outbox_next_ns(const outbox *o)
{
	return o->messages->len ? g_array_index(o->messages, struct outbox_message, 0).due_ns
				: INT64_MAX;
}

struct outbox_message outbox_pop(outbox *o)
{
	struct outbox_message first = g_array_index(o->messages, struct outbox_message, 0);

	g_array_remove_index(o->messages, 0);
	return first;
}

void outbox_discard(outbox *o, enum link_kind kind, int64_t after_ns)
{
	for (guint i = o->messages->len; i-- > 0;) {
		struct outbox_message *message =
			&g_array_index(o->messages, struct outbox_message, i);

		if (message->kind != kind || message->due_ns <= after_ns)
			continue;
		outbox_message_clear(message);
		g_array_remove_index(o->messages, i);
	}
}
