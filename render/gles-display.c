#include "render/gles-display.h"
#include "render/gles-gbm.h"

static bool refuse(GError **error, const char *sentence)
{
	g_set_error_literal(error, GLES_ERROR, GLES_ERROR_NONE, sentence);
	return false;
}

/* ---- which there are ---- */

static bool has_platform(
	const struct egl_functions *egl, enum gles_platform platform, GError **error)
{
	const char *list = egl->QueryString(EGL_NO_DISPLAY, EGL_EXTENSIONS);
	if (!gles_list_has(list, "EGL_EXT_platform_base") || !egl->GetPlatformDisplayEXT)
		return refuse(error, "it has no driver that draws without a window");
	switch (platform) {
	case GLES_SURFACELESS:
		return gles_list_has(list, "EGL_MESA_platform_surfaceless") ||
		       refuse(error, "EGL has no EGL_MESA_platform_surfaceless");
	case GLES_DEVICE:
		return (gles_list_has(list, "EGL_EXT_platform_device") && egl->QueryDevicesEXT) ||
		       refuse(error, "EGL has no EGL_EXT_platform_device");
	default:
		return gles_list_has(list, "EGL_KHR_platform_gbm") ||
		       gles_list_has(list, "EGL_MESA_platform_gbm") ||
		       refuse(error, "EGL has no EGL_KHR_platform_gbm");
	}
}

static unsigned devices(const struct egl_functions *egl, EGLDeviceEXT ret[GLES_DISPLAYS_MAX])
{
	EGLint n = 0;
	return egl->QueryDevicesEXT((EGLint)GLES_DISPLAYS_MAX, ret, &n) && n > 0 ? (unsigned)n : 0;
}

static unsigned list_devices(
	const struct egl_functions *egl, uint32_t ret_number[GLES_DISPLAYS_MAX], GError **error)
{
	EGLDeviceEXT device[GLES_DISPLAYS_MAX];
	unsigned n = devices(egl, device);
	for (unsigned i = 0; i < n; i++)
		ret_number[i] = i;
	if (!n)
		refuse(error, "EGL lists no device");
	return n;
}

unsigned gles_display_list(
	enum gles_platform platform, uint32_t ret_number[GLES_DISPLAYS_MAX], GError **error)
{
	const struct egl_functions *egl = egl_functions_load(error);
	if (!egl || !has_platform(egl, platform, error))
		return 0;
	if (platform == GLES_DEVICE)
		return list_devices(egl, ret_number, error);
	if (platform == GLES_GBM)
		return gles_gbm_list(ret_number, GLES_DISPLAYS_MAX, error);
	ret_number[0] = 0;
	return 1;
}

/* ---- one of them ---- */

static EGLDisplay device_handle(const struct egl_functions *egl, uint32_t number, GError **error)
{
	EGLDeviceEXT device[GLES_DISPLAYS_MAX];
	if (number < devices(egl, device))
		return egl->GetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device[number], NULL);
	refuse(error, "the device is gone");
	return EGL_NO_DISPLAY;
}

static EGLDisplay gbm_handle(const struct egl_functions *egl, uint32_t number, GError **error)
{
	struct gbm_device *gbm = gles_gbm_get(number, error);
	return gbm ? egl->GetPlatformDisplayEXT(EGL_PLATFORM_GBM_KHR, gbm, NULL) : EGL_NO_DISPLAY;
}

static bool find_handle(struct gles_display *d, GError **error)
{
	g_autoptr(GError) why = NULL;
	switch (d->platform) {
	case GLES_SURFACELESS:
		d->handle = d->egl->GetPlatformDisplayEXT(
			EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, NULL);
		break;
	case GLES_DEVICE: d->handle = device_handle(d->egl, d->number, &why); break;
	default: d->handle = gbm_handle(d->egl, d->number, &why);
	}
	if (why)
		g_propagate_error(error, g_steal_pointer(&why));
	else if (d->handle == EGL_NO_DISPLAY)
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE, "EGL gives no display (%s)",
			egl_error_name(d->egl));
	return d->handle != EGL_NO_DISPLAY;
}

static bool start(struct gles_display *d, GError **error)
{
	EGLint major = 0, minor = 0;
	if (d->egl->Initialize(d->handle, &major, &minor)) {
		d->extensions = d->egl->QueryString(d->handle, EGL_EXTENSIONS);
		return true;
	}
	g_set_error(error, GLES_ERROR, GLES_ERROR_NONE, "EGL cannot start its driver (%s)",
		egl_error_name(d->egl));
	return false;
}

static struct gles_display *start_new(enum gles_platform platform, uint32_t number, GError **error)
{
	const struct egl_functions *egl = egl_functions_load(error);
	if (!egl || !has_platform(egl, platform, error))
		return NULL;
	struct gles_display d = { .egl = egl, .platform = platform, .number = number };
	return find_handle(&d, error) && start(&d, error) ? g_memdup2(&d, sizeof d) : NULL;
}

/* ---- once per process ---- */

static GMutex lock;
static GSList *displays;

static const struct gles_display *find(enum gles_platform platform, uint32_t number)
{
	for (GSList *at = displays; at; at = at->next) {
		const struct gles_display *d = at->data;
		if (d->platform == platform && d->number == number)
			return d;
	}
	return NULL;
}

const struct gles_display *gles_display_get(
	enum gles_platform platform, uint32_t number, GError **error)
{
	g_mutex_lock(&lock);
	const struct gles_display *d = find(platform, number);
	struct gles_display *new = d ? NULL : start_new(platform, number, error);
	if (new)
		displays = g_slist_prepend(displays, new);
	g_mutex_unlock(&lock);
	return d ? d : new;
}
