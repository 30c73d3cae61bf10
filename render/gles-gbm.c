#include "render/gles-gbm.h"
#include "render/gles-about.h"
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <gbm.h>
#include <stdbool.h>
#include <stdio.h>
#include <unistd.h>

enum { FIRST = 128, LAST = 191 }; /* the kernel's minors of render nodes */

static __typeof__(gbm_create_device) *create_device;

static bool load(GError **error)
{
	static size_t once;
	if (g_once_init_enter(&once)) {
		void *handle = dlopen("libgbm.so.1", RTLD_NOW | RTLD_LOCAL);
		if (handle)
			create_device =
				(__typeof__(create_device))dlsym(handle, "gbm_create_device");
		g_once_init_leave(&once, 1);
	}
	if (create_device)
		return true;
	g_set_error_literal(
		error, GLES_ERROR, GLES_ERROR_NONE, "there is no libgbm.so.1 on this machine");
	return false;
}

static void node_path(uint32_t number, char ret[32])
{
	snprintf(ret, 32, "/dev/dri/renderD%u", number);
}

unsigned gles_gbm_list(uint32_t *ret_number, unsigned max, GError **error)
{
	unsigned n = 0;
	for (uint32_t number = FIRST; number <= LAST && n < max; number++) {
		char path[32];
		node_path(number, path);
		if (!access(path, F_OK))
			ret_number[n++] = number;
	}
	if (!n)
		g_set_error_literal(error, GLES_ERROR, GLES_ERROR_NONE,
			"the kernel has no render node (/dev/dri/renderD*)");
	return n;
}

struct gbm_device *gles_gbm_get(uint32_t number, GError **error)
{
	char path[32];
	node_path(number, path);
	if (!load(error))
		return NULL;
	int fd = open(path, O_RDWR | O_CLOEXEC);
	if (fd < 0) {
		g_set_error(error, GLES_ERROR, GLES_ERROR_NONE, "%s cannot be opened: %s", path,
			g_strerror(errno));
		return NULL;
	}
	struct gbm_device *device = create_device(fd);
	if (!device) {
		g_set_error(
			error, GLES_ERROR, GLES_ERROR_NONE, "libgbm has no driver for %s", path);
		close(fd);
	}
	return device;
}
