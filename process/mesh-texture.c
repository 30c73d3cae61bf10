#include "process/mesh-texture.h"
#include "firmware-io/files.h"
#include <gio/gio.h>
#include <math.h>
#include <png.h>
#include <string.h>
#include <turbojpeg.h>

#define FILE_BYTES_MAX (512u << 20)
#define SIDE_MAX       65535
#define LEVELS_MAX     17
/* While it is read; of what is larger, a JPEG can be read smaller, a PNG not. */
#define READ_TEXELS_MAX (UINT64_C(1) << 28)
/* A byte stands for 512 texels of a JPEG at most, or for 8256 of a PNG in black and white; twice that, to be on the safe side. */
#define TEXELS_A_BYTE_MAX 16384
/* Of a JPEG of several scans all coefficients are in memory, six bytes a texel, whatever it is read as. */
#define SCANS_TEXELS_MAX (READ_TEXELS_MAX / 2)

struct mesh_texture {
	unsigned levels;
	struct level {
		uint32_t width, height;
		uint8_t *rgb; /* the upper row first */
	} level[LEVELS_MAX];
};

void mesh_texture_free(mesh_texture *t)
{
	for (unsigned i = 0; t && i < t->levels; i++)
		g_free(t->level[i].rgb);
	g_free(t);
}

uint64_t mesh_texture_texels(const mesh_texture *t)
{
	return (uint64_t)t->level[0].width * t->level[0].height;
}

static bool refuse(GError **error, const char *path, const char *why)
{
	g_autofree char *plain = g_utf8_make_valid(why, -1);
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA, "%s: %s", path, plain);
	return false;
}

/* ---- files ---- */

static bool make_room(struct level *l, uint64_t width, uint64_t height)
{
	if (!width || !height || width > SIDE_MAX || height > SIDE_MAX ||
		width * height > READ_TEXELS_MAX)
		return false;
	l->width = (uint32_t)width;
	l->height = (uint32_t)height;
	l->rgb = g_try_malloc_n((size_t)width * height, 3);
	return l->rgb != NULL;
}

static bool check_size(
	uint64_t width, uint64_t height, size_t length, const char *path, GError **error)
{
	if (!width || !height)
		return refuse(error, path, "has no picture");
	return width * height / TEXELS_A_BYTE_MAX <= length ||
	       refuse(error, path, "is cut short: it has fewer bytes than its size needs");
}

static bool read_png(
	struct level *l, const void *bytes, size_t length, const char *path, GError **error)
{
	png_image image = { .version = PNG_IMAGE_VERSION };
	png_color behind = { 255, 255, 255 };
	if (!png_image_begin_read_from_memory(&image, bytes, length))
		return refuse(error, path, image.message);
	image.format = PNG_FORMAT_RGB;
	bool good = check_size(image.width, image.height, length, path, error);
	if (good && !make_room(l, image.width, image.height))
		good = refuse(error, path, "is too large a picture");
	if (good && !png_image_finish_read(&image, &behind, l->rgb, 0, NULL))
		good = refuse(error, path, image.message);
	png_image_free(&image);
	return good;
}

/* Of the sizes that it can be read in, the largest within the limit; the smallest where none is. */
static tjscalingfactor scale_of(int width, int height, uint64_t texels_most)
{
	int count = 0;
	const tjscalingfactor *all = tjGetScalingFactors(&count);
	tjscalingfactor best = { 1, 8 };
	for (int i = 0; i < count; i++) {
		uint64_t texels = (uint64_t)TJSCALED(width, all[i]) * TJSCALED(height, all[i]);
		if (all[i].num <= all[i].denom && texels <= texels_most &&
			all[i].num * best.denom > best.num * all[i].denom)
			best = all[i];
	}
	return best;
}

/* Whether its first scan is not all of it, as in a progressive one; what cannot be told is so too. */
static bool has_scans(const uint8_t *bytes, size_t length)
{
	uint8_t components = 0;
	for (size_t at = 2; at + 10 <= length && bytes[at] == 0xff;) {
		uint8_t kind = bytes[at + 1];
		if (kind == 0xff) {
			at++;
			continue;
		}
		if (kind == 0xc0 || kind == 0xc1)
			components = bytes[at + 9];
		if (kind == 0xda)
			return bytes[at + 4] != components;
		at += 2 + ((size_t)bytes[at + 2] << 8 | bytes[at + 3]);
	}
	return true;
}

static bool make_jpeg_room(struct level *l, const uint8_t *jpeg, size_t length, int width,
	int height, tjscalingfactor scale, const char *path, GError **error)
{
	uint64_t texels = (uint64_t)width * (uint64_t)height;
	if (!check_size((uint64_t)MAX(width, 0), (uint64_t)MAX(height, 0), length, path, error))
		return false;
	if ((texels > SCANS_TEXELS_MAX && has_scans(jpeg, length)) ||
		!make_room(l, (uint64_t)TJSCALED(width, scale), (uint64_t)TJSCALED(height, scale)))
		return refuse(error, path, "is too large a picture");
	return true;
}

static bool read_jpeg(struct level *l, const char *bytes, size_t length, uint64_t texels_most,
	const char *path, GError **error)
{
	tjhandle reader = tjInitDecompress();
	const unsigned char *jpeg = (const unsigned char *)bytes;
	int width = 0, height = 0, sampling, colours; /* of tables alone nothing is said */
	bool good = reader && tjDecompressHeader3(reader, jpeg, length, &width, &height, &sampling,
				      &colours) == 0;
	if (good) {
		tjscalingfactor scale = scale_of(width, height, texels_most);
		good = make_jpeg_room(l, jpeg, length, width, height, scale, path, error);
		/* What libjpeg only warns of is as good as it gets. */
		if (good &&
			tjDecompress2(reader, jpeg, length, l->rgb, (int)l->width, 0,
				(int)l->height, TJPF_RGB, TJFLAG_LIMITSCANS) &&
			tjGetErrorCode(reader) == TJERR_FATAL)
			good = refuse(error, path, tjGetErrorStr2(reader));
	} else
		refuse(error, path, tjGetErrorStr2(reader));
	if (reader)
		tjDestroy(reader);
	return good;
}

/* ---- levels ---- */

/* Each texel the mean of four; of an odd side the last stands for itself twice. */
static struct level half_of(const struct level *from)
{
	struct level l = { (from->width + 1) / 2, (from->height + 1) / 2, NULL };
	l.rgb = g_malloc_n((size_t)l.width * l.height, 3);
	for (uint32_t y = 0; y < l.height; y++) {
		const uint8_t *upper = from->rgb + 3 * (size_t)from->width * (2 * y);
		const uint8_t *lower =
			from->rgb + 3 * (size_t)from->width * MIN(2 * y + 1, from->height - 1);
		uint8_t *into = l.rgb + 3 * (size_t)l.width * y;
		for (uint32_t x = 0; x < l.width; x++) {
			size_t left = 3 * (size_t)(2 * x),
			       right = 3 * (size_t)MIN(2 * x + 1, from->width - 1);
			for (size_t i = 0; i < 3; i++)
				into[3 * (size_t)x + i] =
					(uint8_t)((upper[left + i] + upper[right + i] +
							  lower[left + i] + lower[right + i] + 2) /
						  4);
		}
	}
	return l;
}

static void add_levels(mesh_texture *t, uint64_t texels_most)
{
	struct level *l = t->level;
	t->levels = 1;
	while ((uint64_t)l[0].width * l[0].height > MAX(texels_most, 1)) {
		struct level half = half_of(&l[0]);
		g_free(l[0].rgb);
		l[0] = half;
	}
	for (; l[t->levels - 1].width > 1 || l[t->levels - 1].height > 1; t->levels++)
		l[t->levels] = half_of(&l[t->levels - 1]);
}

mesh_texture *mesh_texture_read(const char *path, uint64_t texels_most, GError **error)
{
	size_t length;
	g_autofree char *bytes = files_read(path, FILE_BYTES_MAX, &length, error);
	g_autoptr(mesh_texture) t = g_new0(mesh_texture, 1);
	if (!bytes)
		return NULL;
	t->levels = 1;
	bool is_png = length > 8 && !png_sig_cmp((png_const_bytep)bytes, 0, 8),
	     is_jpeg = length > 2 && !memcmp(bytes, "\xff\xd8", 2);
	if (!is_png && !is_jpeg)
		return refuse(error, path, "is neither PNG nor JPEG"), NULL;
	if (is_png ? !read_png(&t->level[0], bytes, length, path, error)
		   : !read_jpeg(&t->level[0], bytes, length, texels_most, path, error))
		return NULL;
	add_levels(t, texels_most);
	return g_steal_pointer(&t);
}

/* ---- colours ---- */

static const uint8_t *texel(const struct level *l, int64_t x, int64_t y)
{
	int64_t column = x % l->width, row = y % l->height;
	column += column < 0 ? l->width : 0;
	row += row < 0 ? l->height : 0;
	return l->rgb + 3 * ((size_t)row * l->width + (size_t)column);
}

void mesh_texture_at(const mesh_texture *t, double u, double v, double area, uint8_t ret[3])
{
	double texels = area * t->level[0].width * t->level[0].height;
	double wanted = texels > 1 ? rint(log2(texels) / 2) : 0;
	const struct level *l = &t->level[(unsigned)fmin(wanted, t->levels - 1)];
	/* Whatever a file says, it stays a number that can be a column. */
	double x = (u - floor(u)) * l->width - 0.5, y = (1 - (v - floor(v))) * l->height - 0.5;
	if (!isfinite(x) || !isfinite(y))
		x = y = 0;
	int64_t left = (int64_t)floor(x), upper = (int64_t)floor(y);
	double right_share = x - (double)left, lower_share = y - (double)upper;
	const uint8_t *a = texel(l, left, upper), *b = texel(l, left + 1, upper),
		      *c = texel(l, left, upper + 1), *d = texel(l, left + 1, upper + 1);
	for (int i = 0; i < 3; i++) {
		double above = a[i] + right_share * (b[i] - a[i]),
		       below = c[i] + right_share * (d[i] - c[i]);
		ret[i] = (uint8_t)(above + lower_share * (below - above) + 0.5);
	}
}
