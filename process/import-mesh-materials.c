/* The materials beside an OBJ, for assimp: of their text only what colours a mesh, written anew. assimp's own reader of it writes to
 * nowhere where a line stands before the first material. */
#include "process/import-lines.h"
#include "process/import-mesh.h"
#include "process/import-number.h"
#include <string.h>

/* Names that are longer are none that assimp keeps. */
#define NAME_BYTES_MAX 1000

static const char *word_behind(const char *at, const char *word)
{
	size_t length = strlen(word);
	return !g_ascii_strncasecmp(at, word, length) && import_ends_field(at[length])
		       ? import_skip_blanks(at + length)
		       : NULL;
}

static const char *skip_word(const char *at)
{
	while (!import_ends_field(*at))
		at++;
	return import_skip_blanks(at);
}

/* Options of a picture stand before its name, each with what follows it: of up to three numbers, or words. */
static const char *skip_options(const char *at)
{
	static const struct {
		const char *name;
		int numbers, words;
	} options[] = { { "-o", 3, 0 }, { "-s", 3, 0 }, { "-t", 3, 0 }, { "-mm", 2, 0 },
		{ "-blendu", 0, 1 }, { "-blendv", 0, 1 }, { "-boost", 0, 1 }, { "-texres", 0, 1 },
		{ "-imfchan", 0, 1 }, { "-bm", 0, 1 }, { "-clamp", 0, 1 }, { "-cc", 0, 1 },
		{ "-type", 0, 1 } };
	size_t i = 0;
	while (i < G_N_ELEMENTS(options)) {
		const char *behind = word_behind(at, options[i].name);
		double number;
		if (!behind) {
			i++;
			continue;
		}
		at = behind;
		for (int k = 0; k < options[i].numbers; k++) {
			const char *end = at;
			if (!import_number(&end, &number) || !import_ends_field(*end))
				break;
			at = import_skip_blanks(end);
		}
		for (int k = 0; k < options[i].words; k++)
			at = skip_word(at);
		i = 0;
	}
	return at;
}

static bool add_name(GString *into, const char *word, const char *name)
{
	size_t length = strlen(name);
	if (!length || length > NAME_BYTES_MAX)
		return false;
	g_string_append_printf(into, "%s %s\n", word, name);
	return true;
}

static void add_colour(GString *into, const char *at)
{
	double rgb[3];
	for (int i = 0; i < 3; i++, at = import_skip_blanks(at))
		if (!import_number(&at, &rgb[i]) || !import_ends_field(*at))
			return;
	g_string_append(into, "Kd");
	for (int i = 0; i < 3; i++) {
		char text[G_ASCII_DTOSTR_BUF_SIZE];
		g_string_append_printf(into, " %s",
			g_ascii_formatd(text, sizeof text, "%.6f", CLAMP(rgb[i], 0, 1)));
	}
	g_string_append_c(into, '\n');
}

/* *in_material: whether there is one that a line can be of. */
static void add_line(GString *into, const char *line, bool *in_material)
{
	const char *behind;
	if ((behind = word_behind(line, "newmtl")))
		*in_material = add_name(into, "newmtl", behind);
	else if (!*in_material)
		return;
	else if ((behind = word_behind(line, "Kd")))
		add_colour(into, behind);
	else if ((behind = word_behind(line, "map_Kd")))
		add_name(into, "map_Kd", skip_options(behind));
}

char *mesh_materials(const char *text, size_t length, size_t *ret_length)
{
	g_autofree char *plain = g_strndup("", length);
	for (size_t i = 0; i < length; i++)
		plain[i] = text[i] == '\n' || !g_ascii_iscntrl(text[i]) ? text[i] : ' ';
	g_auto(GStrv) lines = g_strsplit(plain, "\n", -1);
	GString *into =
		g_string_new("# of use here\n"); /* what is shorter than 8 bytes assimp refuses */
	bool in_material = false;
	for (char **line = lines; *line; line++)
		add_line(into, g_strstrip(*line), &in_material);
	*ret_length = into->len;
	return g_string_free(into, false);
}
