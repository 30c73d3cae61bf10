#include "render/gles-shader-text.h"
#include "render/gles-shared-bytes.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Lines of the common text are counted from here. */
#define COMMON 10000u

/* ---- put together ---- */

/* Comments become blanks, so that what is found stands where it stood. */
static char *without_comments(const char *text)
{
	char *plain = g_strdup(text);
	for (char *at = plain; *at;) {
		if (at[0] != '/' || (at[1] != '/' && at[1] != '*')) {
			at++;
			continue;
		}
		bool is_line = at[1] == '/';
		const char *end = strstr(at + 2, is_line ? "\n" : "*/");
		size_t length = end ? (size_t)(end - at) + (is_line ? 0 : 2) : strlen(at);
		for (; length; length--, at++)
			if (*at != '\n')
				*at = ' ';
	}
	return plain;
}

static unsigned lines_before(const char *text, size_t offset)
{
	unsigned n = 0;
	for (size_t i = 0; i < offset; i++)
		n += text[i] == '\n';
	return n;
}

/* Behind the last line with #version or #extension. */
static size_t head_length(const char *plain)
{
	g_autoptr(GRegex) directive = g_regex_new(
		"^[ \\t]*#[ \\t]*(version|extension)\\b.*\\n?", G_REGEX_MULTILINE, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	int end = 0;
	g_regex_match(directive, plain, 0, &found);
	for (; g_match_info_matches(found); g_match_info_next(found, NULL))
		g_match_info_fetch_pos(found, 0, NULL, &end);
	return (size_t)end;
}

static char *join(const char *common, const char *text)
{
	g_autofree char *plain = without_comments(text);
	size_t head = head_length(plain);
	if (!common || !head || text[head - 1] != '\n')
		return g_strdup(text);
	return g_strdup_printf("%.*s#line %u\n%s\n#line %u\n%s", (int)head, text, COMMON + 1,
		common, lines_before(text, head) + 1, text + head);
}

gles_shader_text *gles_shader_text_new(const char *name, const char *common, const char *text)
{
	gles_shader_text *t = g_new0(gles_shader_text, 1);
	t->name = g_strdup(name);
	t->whole = join(common, text);
	t->plain = without_comments(t->whole);
	return t;
}

void gles_shader_text_free(gles_shader_text *t)
{
	if (!t)
		return;
	g_free(t->name);
	g_free(t->whole);
	g_free(t->plain);
	g_free(t);
}

/* ---- places ---- */

static char *place(const gles_shader_text *t, unsigned line)
{
	bool is_common = line > COMMON;
	return g_strdup_printf("%s%s line %u", t->name, is_common ? ", common" : "",
		is_common ? line - COMMON : line);
}

char *gles_shader_text_place(const gles_shader_text *t, size_t offset)
{
	unsigned line = 1;
	for (const char *at = t->plain; at < t->plain + offset;) {
		const char *end = strchr(at, '\n');
		if (!end || end >= t->plain + offset)
			break;
		line++;
		sscanf(at, "#line %u", &line);
		at = end + 1;
	}
	return place(t, line);
}

/* -1: nowhere. */
static int find(const gles_shader_text *t, const char *word)
{
	g_autofree char *escaped = g_regex_escape_string(word, -1);
	g_autofree char *pattern = g_strdup_printf("\\b%s\\b", escaped);
	g_autoptr(GRegex) regex = g_regex_new(pattern, 0, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	int start = -1;
	if (regex && g_regex_match(regex, t->plain, 0, &found))
		g_match_info_fetch_pos(found, 0, &start, NULL);
	return start;
}

bool gles_shader_text_has(const gles_shader_text *t, const char *word)
{
	return find(t, word) >= 0;
}

char *gles_shader_text_place_of(const gles_shader_text *t, const char *word)
{
	int at = find(t, word);
	return at < 0 ? g_strdup(t->name) : gles_shader_text_place(t, (size_t)at);
}

/* ---- checked ---- */

static bool refuse(const gles_shader_text *t, int offset, GError **error, const char *sentence)
{
	g_autofree char *where = gles_shader_text_place(t, (size_t)offset);
	g_set_error(error, GLES_ERROR, GLES_ERROR_LIMIT, "%s: %s", where, sentence);
	return false;
}

static bool check_version(const gles_shader_text *t, GError **error)
{
	g_autoptr(GRegex) wanted =
		g_regex_new("^\\s*#[ \\t]*version[ \\t]+310[ \\t]+es[ \\t]*\\n", 0, 0, NULL);
	if (g_regex_match(wanted, t->plain, 0, NULL))
		return true;
	const char *version = strstr(t->plain, "version");
	return refuse(t, version ? (int)(version - t->plain) : 0, error,
		"it must begin with #version 310 es, the GLSL that small boards have");
}

static const char *extension_reason(const char *name)
{
	static const struct {
		const char *part, *reason;
	} reasons[] = {
		{ "geometry", "small boards have no geometry shaders" },
		{ "tessellation", "small boards have no tessellation shaders" },
		{ "int64", "small boards have no 64-bit integers and atomics" },
		{ "ANDROID_extension_pack", "small boards have no geometry shaders" },
	};
	for (size_t i = 0; i < G_N_ELEMENTS(reasons); i++)
		if (strstr(name, reasons[i].part))
			return reasons[i].reason;
	return "of extensions, small boards surely have GL_OES_shader_image_atomic alone";
}

static bool check_extensions(const gles_shader_text *t, GError **error)
{
	g_autoptr(GRegex) regex =
		g_regex_new("^[ \\t]*#[ \\t]*extension[ \\t]+(\\w+)", G_REGEX_MULTILINE, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	g_regex_match(regex, t->plain, 0, &found);
	for (; g_match_info_matches(found); g_match_info_next(found, NULL)) {
		g_autofree char *name = g_match_info_fetch(found, 1);
		int at = 0;
		g_match_info_fetch_pos(found, 1, &at, NULL);
		if (strcmp(name, "GL_OES_shader_image_atomic")) {
			g_autofree char *sentence =
				g_strdup_printf("it asks for %s; %s", name, extension_reason(name));
			return refuse(t, at, error, sentence);
		}
	}
	return true;
}

static bool check_point_size(const gles_shader_text *t, GError **error)
{
	g_autoptr(GRegex) regex =
		g_regex_new("\\bgl_PointSize\\s*=\\s*([0-9.eE+]+)[fF]?\\s*;", 0, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	g_regex_match(regex, t->plain, 0, &found);
	for (; g_match_info_matches(found); g_match_info_next(found, NULL)) {
		g_autofree char *number = g_match_info_fetch(found, 1);
		int at = 0;
		g_match_info_fetch_pos(found, 0, &at, NULL);
		if (g_ascii_strtod(number, NULL) > 512) {
			g_autofree char *sentence = g_strdup_printf(
				"points of %s pixels; small boards have 512 at most", number);
			return refuse(t, at, error, sentence);
		}
	}
	return true;
}

static bool check_shared(const gles_shader_text *t, GError **error)
{
	struct gles_shared s = gles_shared_bytes(t->plain);
	if (s.unclear) {
		g_autofree char *sentence = g_strdup_printf(
			"how large the shared %s is cannot be told from the text; write numbers "
			"(small boards have 32 KiB)",
			s.unclear);
		refuse(t, (int)s.offset, error, sentence);
		g_free(s.unclear);
		return false;
	}
	if (s.bytes <= 32 * 1024)
		return true;
	g_autofree char *sentence = g_strdup_printf("shared variables of %" G_GUINT64_FORMAT
						    " bytes; small boards have 32768",
		s.bytes);
	return refuse(t, (int)s.offset, error, sentence);
}

bool gles_shader_text_check(const gles_shader_text *t, GError **error)
{
	return check_version(t, error) && check_extensions(t, error) &&
	       check_point_size(t, error) && check_shared(t, error);
}

/* ---- what compilers say ---- */

/* Mesa: "0:12(3): error: ..."; NVIDIA: "0(12) : error C1008: ..."; ANGLE: "ERROR: 0:12: ..."; ARM: "0:12: L0001: ...". */
#define COMPLAINT                                                                                  \
	"^\\s*(?:ERROR:\\s*)?\\d+(?::(\\d+)(?:\\(\\d+\\))?|\\((\\d+)\\))\\s*:\\s*+"                \
	"(?:(?:preprocessor )?error:?\\s*+)?(?:[A-Z]\\d{4}:\\s*+)?(?!warning)(.+)$"

static char *first_line(const char *log)
{
	while (g_ascii_isspace(*log))
		log++;
	return g_strndup(log, strcspn(log, "\n"));
}

char *gles_shader_text_complaint(const gles_shader_text *t, const char *log)
{
	g_autoptr(GRegex) regex =
		g_regex_new(COMPLAINT, G_REGEX_MULTILINE | G_REGEX_CASELESS, 0, NULL);
	g_autoptr(GMatchInfo) found = NULL;
	if (!g_regex_match(regex, log, 0, &found)) {
		g_autofree char *line = first_line(log);
		return g_strdup_printf("%s: %s", t->name, *line ? line : "refused, without a word");
	}
	g_autofree char *colon = g_match_info_fetch(found, 1),
			*bracket = g_match_info_fetch(found, 2),
			*words = g_match_info_fetch(found, 3);
	g_autofree char *where = place(t, (unsigned)atoi(*colon ? colon : bracket));
	return g_strdup_printf("%s: %s", where, g_strchomp(words));
}
