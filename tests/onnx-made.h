#ifndef TESTS_ONNX_MADE_H
#define TESTS_ONNX_MADE_H
/* Small ONNX models, written by hand: the protobuf messages of onnx.proto, as far as convolutions need them. */
#include <glib.h>
#include <stdint.h>
#include <string.h>

static inline void put_varint(GByteArray *to, uint64_t value)
{
	do {
		uint8_t byte = (uint8_t)((value & 0x7f) | (value > 0x7f ? 0x80 : 0));
		g_byte_array_append(to, &byte, 1);
		value >>= 7;
	} while (value);
}

static inline void put_number(GByteArray *to, unsigned field, uint64_t value)
{
	put_varint(to, field << 3);
	put_varint(to, value);
}

static inline void put_bytes(GByteArray *to, unsigned field, const void *bytes, size_t length)
{
	put_varint(to, field << 3 | 2);
	put_varint(to, length);
	g_byte_array_append(to, bytes, (guint)length);
}

static inline void put_text(GByteArray *to, unsigned field, const char *text)
{
	put_bytes(to, field, text, strlen(text));
}

/* Takes part. */
static inline void put_part(GByteArray *to, unsigned field, GByteArray *part)
{
	put_bytes(to, field, part->data, part->len);
	g_byte_array_unref(part);
}

static inline void put_tensor(GByteArray *graph, const char *name, const uint64_t *size,
	unsigned sizes, const float *value)
{
	GByteArray *tensor = g_byte_array_new();
	size_t count = 1;
	for (unsigned i = 0; i < sizes; i++) {
		put_number(tensor, 1, size[i]);
		count *= size[i];
	}
	put_number(tensor, 2, 1); /* float */
	put_text(tensor, 8, name);
	put_bytes(tensor, 9, value, count * sizeof *value);
	put_part(graph, 5, tensor);
}

static inline void put_numbers_attribute(
	GByteArray *node, const char *name, const uint64_t *value, unsigned count)
{
	GByteArray *attribute = g_byte_array_new();
	put_text(attribute, 1, name);
	for (unsigned i = 0; i < count; i++)
		put_number(attribute, 8, value[i]);
	put_number(attribute, 20, 7); /* a list of integers */
	put_part(node, 5, attribute);
}

/* A node of one input and one output, which are named by numbers. */
static inline GByteArray *node_begin(const char *kind, unsigned from, unsigned to)
{
	GByteArray *node = g_byte_array_new();
	g_autofree char *in = g_strdup_printf("t%u", from), *out = g_strdup_printf("t%u", to);
	put_text(node, 1, in);
	put_text(node, 2, out);
	put_text(node, 3, out);
	put_text(node, 4, kind);
	return node;
}

/* side x side weights of outputs x inputs, with a bias of outputs; same size as it comes in if stride is 1. */
static inline void put_convolution(GByteArray *graph, unsigned from, unsigned to, uint64_t inputs,
	uint64_t outputs, uint64_t side, uint64_t stride, const float *weight, const float *bias)
{
	g_autofree char *w = g_strdup_printf("w%u", to), *b = g_strdup_printf("b%u", to);
	GByteArray *node = node_begin("Conv", from, to);
	put_text(node, 1, w);
	put_text(node, 1, b);
	put_numbers_attribute(node, "kernel_shape", (uint64_t[]){ side, side }, 2);
	put_numbers_attribute(node, "strides", (uint64_t[]){ stride, stride }, 2);
	put_numbers_attribute(
		node, "pads", (uint64_t[]){ side / 2, side / 2, side / 2, side / 2 }, 4);
	put_part(graph, 1, node);
	put_tensor(graph, w, (uint64_t[]){ outputs, inputs, side, side }, 4, weight);
	put_tensor(graph, b, &outputs, 1, bias);
}

/* What goes in and comes out, 1 x channels x rows x columns; 0: any. */
static inline void put_shape(GByteArray *graph, unsigned field, unsigned name, uint64_t channels,
	uint64_t rows, uint64_t columns)
{
	GByteArray *shape = g_byte_array_new(), *tensor = g_byte_array_new(),
		   *type = g_byte_array_new(), *info = g_byte_array_new();
	const uint64_t size[4] = { 1, channels, rows, columns };
	for (int i = 0; i < 4; i++) {
		GByteArray *dim = g_byte_array_new();
		if (size[i])
			put_number(dim, 1, size[i]);
		else
			put_text(dim, 2, "any");
		put_part(shape, 1, dim);
	}
	put_number(tensor, 1, 1);
	put_part(tensor, 2, shape);
	put_part(type, 1, tensor);
	g_autofree char *t = g_strdup_printf("t%u", name);
	put_text(info, 1, t);
	put_part(info, 2, type);
	put_part(graph, field, info);
}

/* Takes graph; input t0, output t<last>. */
static inline GByteArray *model_of(GByteArray *graph, uint64_t channels, uint64_t classes,
	unsigned last, uint64_t rows, uint64_t columns)
{
	GByteArray *whole = g_byte_array_new(), *opset = g_byte_array_new();
	put_text(graph, 2, "made by hand");
	put_shape(graph, 11, 0, channels, rows, columns);
	put_shape(graph, 12, last, classes, rows, columns);
	put_number(whole, 1, 7);
	put_number(opset, 2, 11);
	put_part(whole, 8, opset);
	put_part(whole, 7, graph);
	return whole;
}

#endif
