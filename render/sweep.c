/* Sweeps as people write them. */
#include "render/sweep.h"
#include "render/title-name.h"
#include <string.h>

/* ---- text ---- */

static bool refuse(GError **error, const char *format, ...) G_GNUC_PRINTF(2, 3);
static bool refuse(GError **error, const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	g_autofree char *what = g_strdup_vprintf(format, arguments);
	va_end(arguments);
	g_set_error_literal(error, STYLE_ERROR, STYLE_ERROR_FIELD, what);
	return false;
}

/* The end of a part: a letter of that kind outside of lists and quotes, or the text's. */
static const char *end_of_part(const char *c, char at)
{
	bool quoted = false;
	for (int deep = 0; *c && (*c != at || deep > 0 || quoted); c++)
		if (quoted && *c == '\\' && c[1])
			c++;
		else if (*c == '"')
			quoted = !quoted;
		else if (!quoted && strchr("[{", *c))
			deep++;
		else if (!quoted && strchr("]}", *c))
			deep--;
	return c;
}

/* Without the blanks around them; of nothing it is one empty part. */
static GPtrArray *split(const char *text, char at)
{
	GPtrArray *parts = g_ptr_array_new_with_free_func(g_free);
	for (const char *c = text;; c++) {
		const char *end = end_of_part(c, at);
		g_ptr_array_add(parts, g_strstrip(g_strndup(c, (gsize)(end - c))));
		c = end;
		if (!*c)
			return parts;
	}
}

/* ---- parameters ---- */

static void free_parameter(gpointer data)
{
	struct sweep_parameter *p = data;
	g_free(p->name);
	g_ptr_array_unref(p->values);
	g_free(p);
}

static bool is_known(const char *name)
{
	const char *dot = strchr(name, '.');
	return !strcmp(name, "view") || !strcmp(name, "site") || (dot && dot > name && dot[1]);
}

static void add(sweep *s, const char *name, const char *values)
{
	struct sweep_parameter *p = g_new(struct sweep_parameter, 1);
	*p = (struct sweep_parameter){ g_strdup(name), split(values, ',') };
	g_ptr_array_add(s->parameters, p);
	if (strcmp(name, "site"))
		s->count = MAX(s->count, p->values->len);
}

static bool add_assignment(sweep *s, const char *text, GError **error)
{
	const char *equals = strchr(text, '=');
	g_autofree char *name = g_strstrip(g_strndup(text, equals ? (gsize)(equals - text) : 0));
	if (!equals || !is_known(name))
		return refuse(error,
			"'%s' is not STEP.PARAMETER=VALUE,VALUE..., view=... or site=...", text);
	if (sweep_value(s, name, 0))
		return refuse(error, "'%s' is there twice", name);
	add(s, name, equals + 1);
	return true;
}

/* All have values, and one of them or as many as the others. */
static bool check_counts(const sweep *s, GError **error)
{
	for (guint k = 0; k < s->parameters->len; k++) {
		const struct sweep_parameter *p = s->parameters->pdata[k];
		for (guint i = 0; i < p->values->len; i++)
			if (!*(const char *)p->values->pdata[i])
				return refuse(error, "a value of '%s' is empty", p->name);
		if (p->values->len > SWEEP_VALUES_MAX)
			return refuse(error, "'%s' has %u values; %u are the most", p->name,
				p->values->len, SWEEP_VALUES_MAX);
		if (p->values->len != 1 && p->values->len != s->count && strcmp(p->name, "site"))
			return refuse(error, "'%s' has %u values where another has %u", p->name,
				p->values->len, s->count);
	}
	return true;
}

static bool read_setting(sweep *s, const char *text, GError **error)
{
	const char *colon = end_of_part(text, ':');
	g_autofree char *styles = g_strndup(text, (gsize)(colon - text));
	add(s, "style", styles);
	if (!*colon)
		return check_counts(s, error);
	g_autoptr(GPtrArray) assignments = split(colon + 1, ';');
	for (guint k = 0; k < assignments->len; k++)
		if (!add_assignment(s, assignments->pdata[k], error))
			return false;
	return check_counts(s, error);
}

/* "pencil: hatching.length_px". */
static char *own_title(const sweep *s)
{
	g_autoptr(GString) names = g_string_new(NULL);
	for (guint k = 0; k < s->parameters->len; k++) {
		const struct sweep_parameter *p = s->parameters->pdata[k];
		bool is_style = k == 0 && p->values->len == 1;
		if (is_style || p->values->len > 1)
			g_string_append_printf(names, "%s%s", names->len ? ", " : "",
				is_style ? (const char *)p->values->pdata[0] : p->name);
	}
	return g_strdup(names->str);
}

/* ---- the whole ---- */

sweep *sweep_new(const char *text, GError **error)
{
	g_auto(GStrv) parts = g_strsplit(text, "|", 3);
	guint count = g_strv_length(parts);
	g_autoptr(sweep) s = g_new0(sweep, 1);
	s->parameters = g_ptr_array_new_with_free_func(free_parameter);
	if (count != 1 && count != 3)
		return refuse(error, "'%s' is not TITLE | CAPTION | SWEEP", text), NULL;
	if (!read_setting(s, g_strstrip(parts[count - 1]), error))
		return NULL;
	s->title = count == 3 ? g_strdup(g_strstrip(parts[0])) : own_title(s);
	s->caption = g_strdup(count == 3 ? g_strstrip(parts[1]) : "");
	s->name = title_name(s->title, 60, "sweep");
	return g_steal_pointer(&s);
}

void sweep_free(sweep *s)
{
	if (!s)
		return;
	g_free(s->title);
	g_free(s->caption);
	g_free(s->name);
	g_ptr_array_unref(s->parameters);
	g_free(s);
}

static const struct sweep_parameter *parameter(const sweep *s, const char *name)
{
	for (guint k = 0; k < s->parameters->len; k++) {
		const struct sweep_parameter *p = s->parameters->pdata[k];
		if (!strcmp(p->name, name))
			return p;
	}
	return NULL;
}

const char *sweep_value(const sweep *s, const char *name, guint i)
{
	const struct sweep_parameter *p = parameter(s, name);
	return p ? p->values->pdata[p->values->len == 1 ? 0 : i] : NULL;
}

bool sweep_has_site(const sweep *s, const char *name)
{
	const struct sweep_parameter *p = parameter(s, "site");
	for (guint i = 0; p && i < p->values->len; i++)
		if (!strcmp(p->values->pdata[i], name))
			return true;
	return !p;
}
