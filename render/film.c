#include "render/film.h"
#include <errno.h>
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <signal.h>
#include <string.h>
#include <sys/prctl.h>
#include <unistd.h>

#define PROGRAM "ffmpeg"

struct film {
	char *path, *part;
	uint32_t width, height;
	GSubprocess *encoder;
	bool is_whole;
};

/* How each kind is made. Light is that of sRGB, and told so. */
static const struct film_kind {
	const char *suffix;
	const char *const arguments[20];
} kinds[] = {
	{ ".mp4", { "-c:v", "libx264", "-preset", "medium", "-crf", "18", "-movflags", "+faststart",
			  "-f", "mp4" } },
	{ ".webm", { "-c:v", "libvpx-vp9", "-crf", "28", "-b:v", "0", "-row-mt", "1", "-deadline",
			   "good", "-cpu-used", "4", "-f", "webm" } },
};
static const char *const colours[] = { "-vf", "scale=out_color_matrix=bt709:out_range=tv",
	"-pix_fmt", "yuv420p", "-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc",
	"iec61966-2-1", "-color_range", "tv" };

static const struct film_kind *kind_of(const char *path)
{
	for (size_t n = 0; n < G_N_ELEMENTS(kinds); n++)
		if (g_str_has_suffix(path, kinds[n].suffix))
			return &kinds[n];
	return NULL;
}

bool film_is(const char *path)
{
	return kind_of(path);
}

bool film_can(GError **error)
{
	g_autofree char *program = g_find_program_in_path(PROGRAM);
	if (!program)
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_NOT_FOUND,
			"films are made by the program %s, which is not installed", PROGRAM);
	return program;
}

/* ---- the program ---- */

/* An interrupt is for who draws, which ends the encoder then; and it ends with that, however that ends. */
static void enter(gpointer none)
{
	(void)none;
	setpgid(0, 0);
	prctl(PR_SET_PDEATHSIG, SIGKILL);
}

static GPtrArray *command_of(const film *f, double fps)
{
	GPtrArray *all = g_ptr_array_new_with_free_func(g_free);
	char rate[G_ASCII_DTOSTR_BUF_SIZE];
	g_autofree char *size = g_strdup_printf("%ux%u", f->width, f->height);
	g_ascii_formatd(rate, sizeof rate, "%.6g", fps);
	const char *const from[] = { PROGRAM, "-nostdin", "-loglevel", "error", "-y", "-f",
		"rawvideo", "-pix_fmt", "rgba", "-s", size, "-r", rate, "-i", "pipe:0", "-an" };
	const char *const *how = kind_of(f->path)->arguments;
	for (size_t n = 0; n < G_N_ELEMENTS(from); n++)
		g_ptr_array_add(all, g_strdup(from[n]));
	for (size_t n = 0; n < G_N_ELEMENTS(colours); n++)
		g_ptr_array_add(all, g_strdup(colours[n]));
	for (; *how; how++)
		g_ptr_array_add(all, g_strdup(*how));
	/* With its protocol, so that a name with a colon is a name. */
	g_ptr_array_add(all, g_strconcat("file:", f->part, NULL));
	g_ptr_array_add(all, NULL);
	return all;
}

film *film_new(const char *path, uint32_t width, uint32_t height, double fps, GError **error)
{
	g_autoptr(film) f = g_new0(film, 1);
	g_autoptr(GSubprocessLauncher) launcher = g_subprocess_launcher_new(
		G_SUBPROCESS_FLAGS_STDIN_PIPE | G_SUBPROCESS_FLAGS_STDOUT_SILENCE |
		G_SUBPROCESS_FLAGS_STDERR_PIPE);
	if (!film_can(error))
		return NULL;
	f->path = g_strdup(path);
	f->width = width;
	f->height = height;
	f->part = g_strconcat(path, ".part", NULL);
	g_autoptr(GPtrArray) command = command_of(f, fps);
	g_subprocess_launcher_set_child_setup(launcher, enter, NULL, NULL);
	f->encoder =
		g_subprocess_launcher_spawnv(launcher, (const char *const *)command->pdata, error);
	return f->encoder ? g_steal_pointer(&f) : NULL;
}

void film_free(film *f)
{
	if (!f)
		return;
	if (f->encoder && !f->is_whole) {
		g_subprocess_force_exit(f->encoder);
		g_subprocess_wait(f->encoder, NULL, NULL);
		g_unlink(f->part);
	}
	g_clear_object(&f->encoder);
	g_free(f->path);
	g_free(f->part);
	g_free(f);
}

/* ---- pictures ---- */

/* The last line of what it said. */
static bool fail(film *f, GError **error)
{
	char said[2000] = "";
	gsize length;
	g_input_stream_read_all(g_subprocess_get_stderr_pipe(f->encoder), said, sizeof said - 1,
		&length, NULL, NULL);
	g_strchomp(said);
	const char *last = strrchr(said, '\n');
	g_autofree char *text = g_utf8_make_valid(last ? last + 1 : said, -1);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: cannot be written: %s: %s", f->path,
		PROGRAM, *text ? text : "it ended by itself");
	return false;
}

bool film_add(film *f, const struct picture_buffer *p, GError **error)
{
	g_assert(p->width == f->width && p->height == f->height);
	return g_output_stream_write_all(g_subprocess_get_stdin_pipe(f->encoder), p->rgba,
		       (size_t)4 * p->width * p->height, NULL, NULL, NULL) ||
	       fail(f, error);
}

bool film_finish(film *f, GError **error)
{
	g_output_stream_close(g_subprocess_get_stdin_pipe(f->encoder), NULL, NULL);
	if (!g_subprocess_wait_check(f->encoder, NULL, NULL))
		return fail(f, error);
	if (g_rename(f->part, f->path) != 0) {
		g_set_error(error, G_FILE_ERROR, g_file_error_from_errno(errno), "%s: %s", f->path,
			g_strerror(errno));
		return false;
	}
	f->is_whole = true;
	return true;
}
