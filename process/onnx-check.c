#include "process/onnx-check.h"
#include <glib.h>

enum wire { WIRE_VARINT, WIRE_64, WIRE_BYTES, WIRE_32 = 5 };

struct message {
	const uint8_t *at, *end;
};

struct field {
	uint64_t number, value; /* of a varint */
	enum wire wire;
	struct message part; /* of bytes */
};

static bool read_varint(struct message *m, uint64_t *ret)
{
	*ret = 0;
	for (unsigned shift = 0; m->at < m->end && shift < 64; shift += 7) {
		uint8_t byte = *m->at++;
		*ret |= (uint64_t)(byte & 0x7f) << shift;
		if (!(byte & 0x80))
			return true;
	}
	return false;
}

/* false: what stands there is no field, or it is cut off. */
static bool read_field(struct message *m, struct field *ret)
{
	uint64_t tag, size = 0;
	if (!read_varint(m, &tag) || tag >> 3 == 0)
		return false;
	*ret = (struct field){ .number = tag >> 3, .wire = (enum wire)(tag & 7) };
	switch (tag & 7) {
	case WIRE_VARINT: return read_varint(m, &ret->value);
	case WIRE_64: size = 8; break;
	case WIRE_32: size = 4; break;
	case WIRE_BYTES:
		if (!read_varint(m, &size))
			return false;
		break;
	default: return false;
	}
	if (size > (uint64_t)(m->end - m->at))
		return false;
	ret->part = (struct message){ m->at, m->at + size };
	m->at += size;
	return true;
}

/* Calls what with each field; false: it did so, or the message is damaged. */
static bool each_field(
	struct message m, bool (*what)(const struct field *f, void *data), void *data)
{
	struct field f;
	while (m.at < m.end)
		if (!read_field(&m, &f) || !what(&f, data))
			return false;
	return true;
}

/* ---- weights ---- */

#define NUMBERS_MAX (1u << 30)

struct tensor {
	uint64_t numbers, type;
	uint64_t raw_bytes, float_bytes;
	bool has_raw, has_floats;
};

static bool multiply(struct tensor *t, uint64_t size)
{
	if (size > NUMBERS_MAX || t->numbers * size > NUMBERS_MAX)
		return false;
	t->numbers *= size;
	return true;
}

static bool tensor_field(const struct field *f, void *data)
{
	struct tensor *t = data;
	switch (f->number) {
	case 1: { /* sizes, one by one or together */
		struct message sizes = f->part;
		if (f->wire == WIRE_VARINT)
			return multiply(t, f->value);
		for (uint64_t size; sizes.at < sizes.end;)
			if (!read_varint(&sizes, &size) || !multiply(t, size))
				return false;
		return f->wire == WIRE_BYTES;
	}
	case 2: t->type = f->value; return f->wire == WIRE_VARINT;
	case 4:
		t->has_floats = true;
		t->float_bytes += f->wire == WIRE_32 ? 4 : (uint64_t)(f->part.end - f->part.at);
		return f->wire == WIRE_BYTES || f->wire == WIRE_32;
	case 9:
		t->has_raw = true;
		t->raw_bytes = (uint64_t)(f->part.end - f->part.at);
		return f->wire == WIRE_BYTES;
	default: return true;
	}
}

/* Bytes of a number of TensorProto.DataType; 0: not of a fixed size. */
static uint64_t bytes_of_type(uint64_t type)
{
	static const uint8_t bytes[] = { 0, 4, 1, 1, 2, 2, 4, 8, 0, 1, 2, 8, 4, 8, 8, 16, 2 };
	return type < G_N_ELEMENTS(bytes) ? bytes[type] : 0;
}

static bool check_tensor(struct message m)
{
	struct tensor t = { .numbers = 1 };
	if (!each_field(m, tensor_field, &t))
		return false;
	if (t.has_raw)
		return bytes_of_type(t.type) && t.raw_bytes == t.numbers * bytes_of_type(t.type);
	return !t.has_floats || t.float_bytes == 4 * t.numbers;
}

/* ---- the way down to them ---- */

static bool attribute_field(const struct field *f, void *data)
{
	(void)data;
	return f->number != 5 || (f->wire == WIRE_BYTES && check_tensor(f->part));
}

static char *text_of(const struct field *f)
{
	return g_strndup((const char *)f->part.at, (gsize)(f->part.end - f->part.at));
}

/* What inputs can be named by: the name that is the field of that number. */
struct naming {
	GHashTable *names;
	uint64_t number;
};

static bool take_name(const struct field *f, void *data)
{
	struct naming *n = data;
	if (f->number == n->number && f->wire == WIRE_BYTES)
		g_hash_table_add(n->names, text_of(f));
	return true;
}

static bool take_names(struct message m, uint64_t number, GHashTable *names)
{
	struct naming n = { names, number };
	return each_field(m, take_name, &n);
}

/* Inputs (1) are there already; an empty name is one left out. */
static bool node_field(const struct field *f, void *data)
{
	if (f->number == 1) {
		g_autofree char *name = text_of(f);
		return f->wire == WIRE_BYTES && (!*name || g_hash_table_contains(data, name));
	}
	return f->number != 5 ||
	       (f->wire == WIRE_BYTES && each_field(f->part, attribute_field, NULL));
}

/* Weights (5) and inputs of the graph (11) have names that nodes are given; they may stand behind the nodes. */
static bool graph_names(const struct field *f, void *data)
{
	if (f->number != 5 && f->number != 11)
		return true;
	return f->wire == WIRE_BYTES && take_names(f->part, f->number == 5 ? 8 : 1, data) &&
	       (f->number != 5 || check_tensor(f->part));
}

/* Nodes (1) stand in the order that they are worked out in; so what they put out (2) is there for those behind. */
static bool graph_nodes(const struct field *f, void *data)
{
	return f->number != 1 || (f->wire == WIRE_BYTES && each_field(f->part, node_field, data) &&
					 take_names(f->part, 2, data));
}

static bool check_graph(struct message m)
{
	g_autoptr(GHashTable) names = g_hash_table_new_full(g_str_hash, g_str_equal, g_free, NULL);
	return each_field(m, graph_names, names) && each_field(m, graph_nodes, names);
}

static bool model_field(const struct field *f, void *data)
{
	bool *graph = data;
	if (f->number != 7)
		return true;
	*graph = true;
	return f->wire == WIRE_BYTES && check_graph(f->part);
}

bool onnx_check(const uint8_t *bytes, size_t length)
{
	bool graph = false;
	return each_field((struct message){ bytes, bytes + length }, model_field, &graph) && graph;
}
