#include "render/gles-shared-bytes.h"
#include <glib.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

/* More than any board has; products stop there. */
#define PLENTY (UINT64_C(1) << 40)

static uint64_t multiply(uint64_t a, uint64_t b)
{
	return a < PLENTY && b < PLENTY && a * b < PLENTY ? a * b : PLENTY;
}

/* 0: unknown. */
static unsigned type_bytes(const char *type)
{
	static const char *const scalars[] = { "float", "int", "uint", "bool" };
	for (size_t i = 0; i < G_N_ELEMENTS(scalars); i++)
		if (!strcmp(type, scalars[i]))
			return 4;
	const char *digits = type + strcspn(type, "234");
	size_t length = strlen(type);
	if (g_str_has_suffix(type, "vec2"))
		return length <= 5 ? 8 : 0;
	if (g_str_has_suffix(type, "vec3") || g_str_has_suffix(type, "vec4"))
		return length <= 5 ? 16 : 0;
	if (!g_str_has_prefix(type, "mat") || digits != type + 3)
		return 0;
	return 16u * (unsigned)(digits[0] - '0');
}

/* ---- extents ---- */

static uint64_t product(const char *plain, const char *text, unsigned depth);

/* What #define NAME ... or const int NAME = ... says; 0: nothing that is clear. */
static uint64_t named(const char *plain, const char *name, unsigned depth)
{
	g_autofree char *pattern =
		g_strdup_printf("(?:#[ \\t]*define[ \\t]+%s[ \\t]+([^\\n]+)|\\bconst[ "
				"\\t]+(?:(?:high|medium|low)p[ "
				"\\t]+)?u?int[ \\t]+%s[ \\t]*=([^;]+);)",
			name, name);
	g_autoptr(GRegex) regex = g_regex_new(pattern, 0, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	if (!regex || depth > 8 || !g_regex_match(regex, plain, 0, &found))
		return 0;
	g_autofree char *defined = g_match_info_fetch(found, 1),
			*constant = g_match_info_fetch(found, 2);
	const char *value = defined && *defined ? defined : constant;
	/* Given twice, as in #if, either may hold. */
	g_match_info_next(found, NULL);
	return value && !g_match_info_matches(found) ? product(plain, value, depth + 1) : 0;
}

static uint64_t factor(const char *plain, const char *text, unsigned depth)
{
	char *end = NULL;
	if (!g_ascii_isdigit(*text))
		return g_regex_match_simple("^\\w+$", text, 0, 0) ? named(plain, text, depth) : 0;
	uint64_t value = g_ascii_strtoull(text, &end, 0);
	if (*end == 'u' || *end == 'U')
		end++;
	return *end ? 0 : value;
}

/* 0: unclear. */
static uint64_t product(const char *plain, const char *text, unsigned depth)
{
	g_auto(GStrv) factors = g_strsplit_set(text, "*", -1);
	uint64_t value = 1;
	for (char **f = factors; *f; f++) {
		char *bare = g_strstrip(*f);
		/* (64 * 4): the brackets of a #define. */
		while (*bare == '(' || g_ascii_isspace(*bare))
			bare++;
		bare[strcspn(bare, ") \t")] = 0;
		value = multiply(value, factor(plain, bare, depth));
	}
	return strpbrk(text, "+-/%<>?") ? 0 : value;
}

/* "[64][N * 2]" of the type's or the name's brackets; 0: unclear. */
static uint64_t extents(const char *plain, const char *brackets)
{
	uint64_t value = 1;
	for (const char *at = strchr(brackets, '['); at; at = strchr(at + 1, '[')) {
		g_autofree char *inside = g_strndup(at + 1, strcspn(at + 1, "]"));
		value = multiply(value, product(plain, inside, 0));
	}
	return value;
}

/* ---- declarations ---- */

/* "float a[64], b" of one declaration without "shared"; 0: unclear. */
static uint64_t declared_bytes(
	const char *plain, const char *type, const char *type_brackets, const char *declarators)
{
	uint64_t each = multiply(type_bytes(type), extents(plain, type_brackets)), sum = 0;
	g_auto(GStrv) names = g_strsplit(declarators, ",", -1);
	for (char **n = names; *n; n++) {
		uint64_t bytes = multiply(each, extents(plain, *n));
		if (!bytes)
			return 0;
		sum += bytes;
	}
	return sum;
}

static bool add(struct gles_shared *s, const char *plain, GMatchInfo *found, uint64_t *largest)
{
	g_autofree char *type = g_match_info_fetch(found, 1),
			*brackets = g_match_info_fetch(found, 2),
			*declarators = g_match_info_fetch(found, 3);
	uint64_t bytes = declared_bytes(plain, type, brackets, declarators);
	int at = 0;
	g_match_info_fetch_pos(found, 0, &at, NULL);
	s->bytes += bytes;
	if (!bytes || bytes > *largest)
		s->offset = (size_t)at;
	*largest = MAX(*largest, bytes);
	if (!bytes)
		s->unclear = g_strdup_printf("%s %s", type, g_strstrip(declarators));
	return bytes;
}

struct gles_shared gles_shared_bytes(const char *plain)
{
	g_autoptr(GRegex) regex =
		g_regex_new("\\bshared\\s+(?:(?:high|medium|low)p\\s+|coherent\\s+|volatile\\s+)*("
			    "\\w+)\\s*((?:\\[[^\\]]*\\]\\s*)*)"
			    "([^;{]*)",
			0, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	struct gles_shared s = { 0 };
	uint64_t largest = 0;
	g_regex_match(regex, plain, 0, &found);
	while (g_match_info_matches(found) && add(&s, plain, found, &largest))
		g_match_info_next(found, NULL);
	return s;
}
