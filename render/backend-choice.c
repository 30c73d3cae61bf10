#include "render/backend-choice.h"
#include "render/gles-probe.h"
#include <string.h>

/* What drivers of GPUs are known by in /dev: that of the kernel's graphics, of NVIDIA, of Windows' Linux, and of boards (Mali, Adreno,
 * Tegra, Vivante, PowerVR). */
static const char *const gpu_files[] = { "dri", "nvidia", "dxg", "mali", "kgsl", "nvhost", "nvmap",
	"galcore", "pvr" };

void backend_choice_clear(backend_choice *c)
{
	g_clear_pointer(&c->why, g_free);
}

bool backend_wish_parse(const char *text, enum backend_wish *ret, GError **error)
{
	static const char *const names[] = { "auto", "cpu", "gles" };
	for (unsigned i = 0; i < G_N_ELEMENTS(names); i++)
		if (!strcmp(text ? text : "auto", names[i])) {
			*ret = (enum backend_wish)i;
			return true;
		}
	g_set_error(error, G_OPTION_ERROR, G_OPTION_ERROR_BAD_VALUE,
		"there is no backend \"%s\"; there are auto, cpu and gles", text);
	return false;
}

static void choose_gles(const struct gles_about *found, backend_choice *ret)
{
	g_autofree char *text = gles_about_text(found);
	ret->backend = BACKEND_GLES;
	ret->found = *found;
	ret->why = g_strdup_printf("gles: %s%s", text,
		found->is_software ? ", which is software: cpu would be faster" : "");
}

/* "cpu: the only OpenGL here is software (llvmpipe)": the first word of the renderer says it all. */
static void choose_cpu(const struct gles_about *found, const GError *why_none, backend_choice *ret)
{
	ret->backend = BACKEND_CPU;
	if (found)
		ret->why = g_strdup_printf("cpu: the only OpenGL here is software (%.*s)",
			(int)strcspn(found->renderer, " ("), found->renderer);
	else
		ret->why = g_strdup_printf("cpu: %s", why_none->message);
}

bool backend_choose(enum backend_wish wish, const struct gles_about *found, const GError *why_none,
	backend_choice *ret, GError **error)
{
	*ret = (backend_choice){ 0 };
	if (wish == BACKEND_WISH_CPU) {
		ret->why = g_strdup("cpu: as asked for");
		return true;
	}
	if (wish == BACKEND_WISH_GLES && !found) {
		g_set_error(error, GLES_ERROR, why_none->code, "gles was asked for, but %s",
			why_none->message);
		return false;
	}
	if (found && (!found->is_software || wish == BACKEND_WISH_GLES))
		choose_gles(found, ret);
	else
		choose_cpu(found, why_none, ret);
	return true;
}

bool backend_may_have_gpu(const char *devices)
{
	g_autoptr(GDir) all = g_dir_open(devices, 0, NULL);
	const char *name;
	while (all && (name = g_dir_read_name(all)))
		for (size_t i = 0; i < G_N_ELEMENTS(gpu_files); i++)
			if (g_str_has_prefix(name, gpu_files[i]))
				return true;
	return !all;
}

bool backend_choose_here(enum backend_wish wish, backend_choice *ret, GError **error)
{
	struct gles_about found;
	g_autoptr(GError) why_none = NULL;
	/* Then all that could be found is software, for which three programs would have to look. */
	if (wish == BACKEND_WISH_AUTO && !g_getenv("PLEINAIR_EGL") &&
		!backend_may_have_gpu("/dev")) {
		*ret = (backend_choice){ .why = g_strdup("cpu: there is no GPU here") };
		return true;
	}
	bool is_found = wish != BACKEND_WISH_CPU && gles_context_probe(NULL, &found, &why_none);
	return backend_choose(wish, is_found ? &found : NULL, why_none, ret, error);
}
