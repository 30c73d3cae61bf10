#include "render/picture-writer.h"
#include "firmware-io/files.h"
#include <fcntl.h>
#include <gio/gio.h>
#include <math.h>
#include <png.h>
#include <stdio.h>
#include <string.h>
#include <tiffio.h>
#include <unistd.h>

/* The file is as large as little time makes it: pictures of strokes have much that repeats. */
#define COMPRESSION 3

struct picture_writer {
	char *path, *beside;
	int fd;     /* of the file beside, until it is whole; -1 */
	FILE *file; /* of PNG, with a descriptor of its own */
	png_structp png;
	png_infop info;
	TIFF *tiff;
	uint32_t width, height, row; /* the next one */
	uint8_t *rgb;                /* of a row */
	char *wrong;                 /* what libpng said */
};

/* ---- PNG ---- */

static void fail_png(png_structp png, png_const_charp what)
{
	picture_writer *w = png_get_error_ptr(png);
	g_free(w->wrong);
	w->wrong = g_strdup(what);
	png_longjmp(png, 1);
}

static void warn_png(png_structp png, png_const_charp what)
{
	(void)png;
	(void)what;
}

static bool refuse(const picture_writer *w, GError **error)
{
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_FAILED, "%s: cannot write: %s", w->path,
		w->wrong ? w->wrong : "the picture is not as it was said to be");
	return false;
}

static bool begin_png(picture_writer *w, double dpi, GError **error)
{
	w->file = fdopen(dup(w->fd), "wb");
	if (!w->file)
		return files_fail(error, w->path, "write");
	w->png = png_create_write_struct(PNG_LIBPNG_VER_STRING, w, fail_png, warn_png);
	w->info = w->png ? png_create_info_struct(w->png) : NULL;
	if (!w->info || setjmp(png_jmpbuf(w->png)))
		return refuse(w, error);
	png_init_io(w->png, w->file);
	png_set_user_limits(w->png, CAMERA_SIDE_MAX, CAMERA_SIDE_MAX);
	png_set_IHDR(w->png, w->info, w->width, w->height, 8, PNG_COLOR_TYPE_RGB,
		PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
	png_set_sRGB(w->png, w->info, PNG_sRGB_INTENT_PERCEPTUAL);
	png_set_compression_level(w->png, COMPRESSION);
	png_set_filter(
		w->png, PNG_FILTER_TYPE_BASE, PNG_FILTER_NONE | PNG_FILTER_SUB | PNG_FILTER_UP);
	if (dpi > 0) {
		uint32_t per_m = (uint32_t)lround(dpi / 0.0254);
		png_set_pHYs(w->png, w->info, per_m, per_m, PNG_RESOLUTION_METER);
	}
	png_write_info(w->png, w->info);
	return true;
}

static bool end_png(picture_writer *w, GError **error)
{
	if (setjmp(png_jmpbuf(w->png)))
		return refuse(w, error);
	png_write_end(w->png, w->info);
	FILE *file = g_steal_pointer(&w->file);
	return fclose(file) == 0 || files_fail(error, w->path, "write");
}

static bool add_png_row(picture_writer *w, GError **error)
{
	if (setjmp(png_jmpbuf(w->png)))
		return refuse(w, error);
	png_write_row(w->png, w->rgb);
	return true;
}

/* ---- TIFF ---- */

static bool begin_tiff(picture_writer *w, double dpi, GError **error)
{
	int fd = dup(w->fd);
	w->tiff = fd < 0 ? NULL : TIFFFdOpen(fd, w->path, "w");
	if (!w->tiff) {
		if (fd >= 0)
			close(fd);
		return files_fail(error, w->path, "write");
	}
	TIFFSetField(w->tiff, TIFFTAG_IMAGEWIDTH, w->width);
	TIFFSetField(w->tiff, TIFFTAG_IMAGELENGTH, w->height);
	TIFFSetField(w->tiff, TIFFTAG_BITSPERSAMPLE, 8);
	TIFFSetField(w->tiff, TIFFTAG_SAMPLESPERPIXEL, 3);
	TIFFSetField(w->tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_RGB);
	TIFFSetField(w->tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
	TIFFSetField(w->tiff, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
	TIFFSetField(w->tiff, TIFFTAG_ZIPQUALITY, COMPRESSION);
	TIFFSetField(w->tiff, TIFFTAG_PREDICTOR, PREDICTOR_HORIZONTAL);
	TIFFSetField(w->tiff, TIFFTAG_ROWSPERSTRIP, 64);
	if (dpi > 0) {
		TIFFSetField(w->tiff, TIFFTAG_XRESOLUTION, dpi);
		TIFFSetField(w->tiff, TIFFTAG_YRESOLUTION, dpi);
		TIFFSetField(w->tiff, TIFFTAG_RESOLUTIONUNIT, RESUNIT_INCH);
	}
	return true;
}

static bool add_tiff_row(picture_writer *w, GError **error)
{
	return TIFFWriteScanline(w->tiff, w->rgb, w->row, 0) == 1 || refuse(w, error);
}

static bool end_tiff(picture_writer *w, GError **error)
{
	bool good = TIFFFlush(w->tiff) == 1;
	TIFFClose(g_steal_pointer(&w->tiff));
	return good || files_fail(error, w->path, "write");
}

/* ---- all ---- */

static bool is_tiff(const char *path)
{
	return g_str_has_suffix(path, ".tif") || g_str_has_suffix(path, ".tiff");
}

static char *beside(const char *path)
{
	g_autofree char *folder = g_path_get_dirname(path), *name = g_path_get_basename(path),
			*other = g_strdup_printf(".%s.new", name);
	return g_build_filename(folder, other, NULL);
}

picture_writer *picture_writer_new(
	const char *path, uint32_t width, uint32_t height, double dpi, GError **error)
{
	g_autoptr(picture_writer) w = g_new0(picture_writer, 1);
	w->path = g_strdup(path);
	w->beside = beside(path);
	w->width = width;
	w->height = height;
	w->rgb = g_malloc_n(width, 3);
	w->fd = open(w->beside, O_RDWR | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
	if (w->fd < 0) {
		files_fail(error, path, "write");
		return NULL;
	}
	bool good = is_tiff(path) ? begin_tiff(w, dpi, error) : begin_png(w, dpi, error);
	return good ? g_steal_pointer(&w) : NULL;
}

bool picture_writer_add(picture_writer *w, const struct picture_buffer *rows, GError **error)
{
	g_assert(rows->width == w->width && rows->height <= w->height - w->row);
	for (uint32_t y = 0; y < rows->height; y++, w->row++) {
		const uint8_t(*from)[4] = (const void *)(rows->rgba + (size_t)y * w->width);
		for (uint32_t x = 0; x < w->width; x++)
			memcpy(w->rgb + 3 * (size_t)x, from[x], 3);
		if (!(w->tiff ? add_tiff_row(w, error) : add_png_row(w, error)))
			return false;
	}
	return true;
}

bool picture_writer_finish(picture_writer *w, GError **error)
{
	g_assert(w->row == w->height);
	if (!(w->tiff ? end_tiff(w, error) : end_png(w, error)))
		return false;
	bool good = fsync(w->fd) == 0;
	good &= close(w->fd) == 0;
	w->fd = -1;
	if (good && rename(w->beside, w->path) == 0) {
		g_autofree char *folder = g_path_get_dirname(w->path);
		return files_sync_folder(folder, error);
	}
	files_fail(error, w->path, "write");
	unlink(w->beside);
	return false;
}

void picture_writer_free(picture_writer *w)
{
	if (!w)
		return;
	if (w->png)
		png_destroy_write_struct(&w->png, &w->info);
	if (w->file)
		fclose(w->file);
	if (w->tiff)
		TIFFClose(w->tiff);
	if (w->fd >= 0) {
		close(w->fd);
		unlink(w->beside);
	}
	g_free(w->wrong);
	g_free(w->rgb);
	g_free(w->beside);
	g_free(w->path);
	g_free(w);
}
