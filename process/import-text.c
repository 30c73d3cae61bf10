#include "process/import-cloud.h"
#include "process/import-number.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define PADDING 64

uint8_t *import_load(import_source *file, uint64_t offset, size_t *ret_length, GError **error)
{
	uint64_t size = import_source_size(file), length = size - MIN(offset, size);
	g_autofree uint8_t *bytes = g_try_malloc(length + PADDING);
	size_t got;
	if (!bytes)
		return import_refuse(error, file, G_IO_ERROR_NOT_SUPPORTED,
			       "its %" G_GUINT64_FORMAT " bytes are more than the memory holds",
			       size),
		       NULL;
	if (!import_source_read(file, offset, bytes, (size_t)length, &got, error))
		return NULL;
	if (got != length)
		return import_refuse(error, file, G_IO_ERROR_INVALID_DATA,
			       "is cut short at byte %" G_GUINT64_FORMAT, offset + got),
		       NULL;
	memset(bytes + length, 0, PADDING);
	*ret_length = (size_t)length;
	return g_steal_pointer(&bytes);
}

bool import_text_refuse(const struct import_text *t, GError **error, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	g_autofree char *what = g_strdup_vprintf(format, args);
	va_end(args);
	return import_refuse(error, t->file, G_IO_ERROR_INVALID_DATA,
		"line %" G_GUINT64_FORMAT ": %s", t->line, what);
}

static bool is_blank(char c)
{
	return c == ' ' || c == '\t' || c == '\r';
}

static void skip_blanks(struct import_text *t)
{
	while (is_blank(*t->at))
		t->at++;
}

static bool read_word(const char **at, double *ret)
{
	static const struct {
		const char *word;
		double value;
	} words[] = { { "nan", NAN }, { "infinity", INFINITY }, { "inf", INFINITY } };
	const char *word = *at + (**at == '-' || **at == '+');
	for (size_t i = 0; i < G_N_ELEMENTS(words); i++) {
		size_t length = strlen(words[i].word);
		if (g_ascii_strncasecmp(word, words[i].word, length) != 0)
			continue;
		*at = word + length;
		*ret = words[i].value;
		return true;
	}
	return false;
}

static const struct {
	double min, max;
	const char *name;
} whole[CLOUD_F32] = { { -128, 127, "8 bit" }, { 0, 255, "8 bit" }, { -32768, 32767, "16 bit" },
	{ 0, 65535, "16 bit" }, { -2147483648.0, 2147483647.0, "32 bit" },
	{ 0, 4294967295.0, "32 bit" }, { -9.3e18, 9.3e18, "64 bit" }, { 0, 1.9e19, "64 bit" } };

bool import_text_number(struct import_text *t, enum cloud_type type, double *ret, GError **error)
{
	skip_blanks(t);
	const char *before = t->at;
	bool good = import_number(&t->at, ret) || read_word(&t->at, ret);
	if (!good || !(is_blank(*t->at) || *t->at == '\n' || t->at == t->end)) {
		t->at = before;
		if (*before == '\n' || before == t->end)
			return import_text_refuse(t, error, "has too few numbers");
		return import_text_refuse(t, error, "'%.10s' is not a number", before);
	}
	if (type >= CLOUD_F32 ||
		(*ret >= whole[type].min && *ret <= whole[type].max && *ret == floor(*ret)))
		return true;
	return import_text_refuse(t, error, "%g is no whole number of %s%s", *ret, whole[type].name,
		whole[type].min < 0 ? "" : " without a sign");
}

bool import_text_end_line(struct import_text *t, GError **error)
{
	skip_blanks(t);
	if (t->at < t->end && *t->at != '\n')
		return import_text_refuse(t, error, "has too many numbers");
	while (t->at < t->end && *t->at == '\n') {
		t->at++;
		t->line++;
		skip_blanks(t);
	}
	return true;
}
