#include "render/gles-shaders.h"
#include <glib.h>
#include <string.h>

const char *gles_shader_find(const char *name)
{
	for (const struct gles_shader *s = gles_shaders; s->name; s++)
		if (strcmp(s->name, name) == 0)
			return s->text;
	return NULL;
}

char *gles_shaders_join(const char *const *names)
{
	GString *all = g_string_new(NULL);
	for (; *names; names++) {
		const char *text = gles_shader_find(*names);
		g_assert(text);
		g_string_append(all, text);
	}
	return g_string_free(all, FALSE);
}
