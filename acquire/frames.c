#include "acquire/frames.h"
#include "acquire/srgb.h"
#include "firmware-io/camera-format.h"
#include <string.h>
#include <turbojpeg.h>

#define TEN_BITS 1024

struct frames {
	tjhandle jpeg;
	uint8_t *nv12, *scratch;
	size_t nv12_room, scratch_room;
	uint8_t srgb[TEN_BITS]; /* of a linear value */
};

/* As stamps of YUV are weighed; rows of Y, Cb, Cr from R, G, B in 0..255, before 16 or 128 is added. */
static const float to_601[3][3] = {
	{ 0.299f * 219 / 255, 0.587f * 219 / 255, 0.114f * 219 / 255 },
	{ -0.168736f * 224 / 255, -0.331264f * 224 / 255, 0.5f * 224 / 255 },
	{ 0.5f * 224 / 255, -0.418688f * 224 / 255, -0.081312f * 224 / 255 },
};
/* BT.709's Y, Cb, Cr, of the same range, to BT.601's. */
static const float from_709[3][3] = {
	{ 1, 0.101579f, 0.196076f },
	{ 0, 0.989854f, -0.110653f },
	{ 0, -0.072453f, 0.983398f },
};

frames *frames_new(void)
{
	frames *f = g_new0(frames, 1);
	for (int i = 0; i < TEN_BITS; i++)
		f->srgb[i] = (uint8_t)lrint(255 * srgb_of(i / (TEN_BITS - 1.0)));
	return f;
}

void frames_free(frames *f)
{
	if (!f)
		return;
	if (f->jpeg)
		tjDestroy(f->jpeg);
	g_free(f->nv12);
	g_free(f->scratch);
	g_free(f);
}

static uint8_t *have_room(uint8_t **bytes, size_t *room, size_t wanted)
{
	if (*room < wanted) {
		g_free(*bytes);
		*bytes = g_malloc(wanted);
		*room = wanted;
	}
	return *bytes;
}

static uint8_t to_byte(float v)
{
	return (uint8_t)CLAMP(lrintf(v), 0, 255);
}

/* ---- YUYV ---- */

static void from_yuyv(uint8_t *nv12, const uint8_t *yuyv, uint32_t width, uint32_t height)
{
	uint8_t *chroma = nv12 + (size_t)width * height;
	for (uint32_t y = 0; y < height; y++)
		for (uint32_t x = 0; x < width; x++)
			nv12[(size_t)y * width + x] = yuyv[((size_t)y * width + x) * 2];
	for (uint32_t y = 0; y < height; y += 2) {
		const uint8_t *row = yuyv + (size_t)y * width * 2, *below = row + (size_t)width * 2;
		for (uint32_t i = 0; i < width; i++)
			*chroma++ = (uint8_t)((row[2 * i + 1] + below[2 * i + 1] + 1) / 2);
	}
}

/* ---- Bayer ---- */

struct mosaic {
	const uint8_t *bytes;
	const struct camera_format *format;
	uint32_t width, height;
};

/* Ten bits, whatever there are; outside is mirrored, which keeps the colour. */
static unsigned mosaic_at(const struct mosaic *m, int64_t x, int64_t y)
{
	x = x < 0 ? -x : x >= m->width ? 2 * (int64_t)m->width - 2 - x : x;
	y = y < 0 ? -y : y >= m->height ? 2 * (int64_t)m->height - 2 - y : y;
	const uint8_t *row = m->bytes + (size_t)y * camera_format_row_bytes(m->format, m->width);
	switch (m->format->layout) {
	case CAMERA_BAYER_8: return row[x] * 1023u / 255;
	case CAMERA_BAYER_10: return (row[2 * x] | (unsigned)row[2 * x + 1] << 8) & 1023;
	default: {
		const uint8_t *four = row + x / 4 * 5;
		return (unsigned)four[x % 4] << 2 | (four[4] >> (2 * (x % 4)) & 3);
	}
	}
}

/* Bilinear: what a pixel does not see is the mean of its neighbours that do. */
static void demosaic(const struct mosaic *m, int64_t x, int64_t y, unsigned rgb[3])
{
	bool red_column = (x & 1) == m->format->red_x, red_row = (y & 1) == m->format->red_y;
	unsigned here = mosaic_at(m, x, y),
		 beside = mosaic_at(m, x - 1, y) + mosaic_at(m, x + 1, y),
		 above = mosaic_at(m, x, y - 1) + mosaic_at(m, x, y + 1);
	if (red_column != red_row) { /* green */
		rgb[red_row ? 0 : 2] = (beside + 1) / 2;
		rgb[1] = here;
		rgb[red_row ? 2 : 0] = (above + 1) / 2;
		return;
	}
	unsigned corners = mosaic_at(m, x - 1, y - 1) + mosaic_at(m, x + 1, y - 1) +
			   mosaic_at(m, x - 1, y + 1) + mosaic_at(m, x + 1, y + 1);
	rgb[red_row ? 0 : 2] = here;
	rgb[1] = (beside + above + 2) / 4;
	rgb[red_row ? 2 : 0] = (corners + 2) / 4;
}

static void from_bayer(const frames *f, uint8_t *nv12, const struct mosaic *m)
{
	size_t w = m->width;
	uint8_t *chroma = nv12 + w * m->height;
#pragma omp parallel for
	for (uint32_t y = 0; y < m->height; y += 2)
		for (uint32_t x = 0; x < m->width; x += 2) {
			float cb = 0, cr = 0;
			for (uint32_t k = 0; k < 4; k++) {
				unsigned linear[3];
				float v[3], luma = 16;
				demosaic(m, x + k % 2, y + k / 2, linear);
				for (int i = 0; i < 3; i++) {
					v[i] = f->srgb[linear[i]];
					luma += to_601[0][i] * v[i];
					cb += to_601[1][i] * v[i] / 4;
					cr += to_601[2][i] * v[i] / 4;
				}
				nv12[(y + k / 2) * w + x + k % 2] = to_byte(luma);
			}
			chroma[(size_t)y / 2 * w + x] = to_byte(128 + cb);
			chroma[(size_t)y / 2 * w + x + 1] = to_byte(128 + cr);
		}
}

/* ---- MJPEG ---- */

/* Mean of a block of a plane, as it is subsampled beyond 4:2:0 or less; sides are those of the block. */
static unsigned mean_of(
	const uint8_t *plane, size_t stride, uint32_t x, uint32_t y, uint32_t across, uint32_t down)
{
	unsigned sum = 0;
	for (uint32_t j = 0; j < down; j++)
		for (uint32_t i = 0; i < across; i++)
			sum += plane[(size_t)(y * down + j) * stride + x * across + i];
	return (sum + across * down / 2) / (across * down);
}

static bool is_usual(int subsampling)
{
	return subsampling == TJSAMP_444 || subsampling == TJSAMP_422 ||
	       subsampling == TJSAMP_420 || subsampling == TJSAMP_440 || subsampling == TJSAMP_GRAY;
}

/* The chroma of a JPEG's planes, two by two pixels each. */
static void take_chroma(uint8_t *chroma, const uint8_t *cb, const uint8_t *cr, int subsampling,
	uint32_t width, uint32_t height)
{
	if (subsampling == TJSAMP_GRAY) {
		memset(chroma, 128, (size_t)width * height / 2);
		return;
	}
	size_t stride = (size_t)tjPlaneWidth(1, (int)width, subsampling);
	uint32_t across = subsampling == TJSAMP_444 || subsampling == TJSAMP_440 ? 2 : 1,
		 down = subsampling == TJSAMP_444 || subsampling == TJSAMP_422 ? 2 : 1;
	for (uint32_t y = 0; y < height / 2; y++)
		for (uint32_t x = 0; x < width / 2; x++) {
			*chroma++ = (uint8_t)mean_of(cb, stride, x, y, across, down);
			*chroma++ = (uint8_t)mean_of(cr, stride, x, y, across, down);
		}
}

static bool from_jpeg(frames *f, uint8_t *nv12, const struct camera_frame_info *info,
	const uint8_t *bytes, size_t length)
{
	int width, height, subsampling, colours;
	if (!f->jpeg)
		f->jpeg = tjInitDecompress();
	if (!camera_format_is_whole_jpeg(bytes, length) ||
		tjDecompressHeader3(
			f->jpeg, bytes, length, &width, &height, &subsampling, &colours) < 0 ||
		(uint32_t)width != info->width || (uint32_t)height != info->height ||
		!is_usual(subsampling) || (colours != TJCS_YCbCr && colours != TJCS_GRAY))
		return false;
	size_t n = (size_t)width * (size_t)height;
	uint8_t *scratch = have_room(&f->scratch, &f->scratch_room, 2 * n);
	uint8_t *planes[3] = { nv12, scratch, scratch + n };
	if (tjDecompressToYUVPlanes(f->jpeg, bytes, length, planes, width, NULL, height,
		    TJFLAG_STOPONWARNING | TJFLAG_ACCURATEDCT) < 0)
		return false;
	take_chroma(nv12 + n, planes[1], planes[2], subsampling, info->width, info->height);
	return true;
}

/* ---- ranges and matrices ---- */

static void to_limited_range(uint8_t *nv12, uint32_t width, uint32_t height)
{
	uint8_t luma[256], chroma[256];
	size_t n = (size_t)width * height;
	for (int i = 0; i < 256; i++) {
		luma[i] = to_byte(16 + (float)i * 219 / 255);
		chroma[i] = to_byte(128 + (float)(i - 128) * 224 / 255);
	}
	for (size_t i = 0; i < n; i++)
		nv12[i] = luma[nv12[i]];
	for (size_t i = n; i < n + n / 2; i++)
		nv12[i] = chroma[nv12[i]];
}

static void to_bt601(uint8_t *nv12, uint32_t width, uint32_t height)
{
	uint8_t *chroma = nv12 + (size_t)width * height;
	for (uint32_t y = 0; y < height; y += 2)
		for (uint32_t x = 0; x < width; x += 2) {
			uint8_t *c = chroma + (size_t)y / 2 * width + x;
			float cb = (float)c[0] - 128, cr = (float)c[1] - 128,
			      more = from_709[0][1] * cb + from_709[0][2] * cr;
			for (uint32_t k = 0; k < 4; k++) {
				uint8_t *l = nv12 + (size_t)(y + k / 2) * width + x + k % 2;
				*l = to_byte(*l + more);
			}
			c[0] = to_byte(128 + from_709[1][1] * cb + from_709[1][2] * cr);
			c[1] = to_byte(128 + from_709[2][1] * cb + from_709[2][2] * cr);
		}
}

/* ---- any ---- */

static bool convert(frames *f, uint8_t *nv12, const struct camera_format *format,
	const struct camera_frame_info *info, const uint8_t *pixels, size_t bytes)
{
	switch (format->layout) {
	case CAMERA_YUYV: from_yuyv(nv12, pixels, info->width, info->height); return true;
	case CAMERA_NV12: memcpy(nv12, pixels, bytes); return true;
	case CAMERA_MJPEG: return from_jpeg(f, nv12, info, pixels, bytes);
	default:
		from_bayer(f, nv12, &(struct mosaic){ pixels, format, info->width, info->height });
		return true;
	}
}

const uint8_t *frames_nv12(frames *f, const struct camera_frame_info *info, const uint8_t *pixels,
	size_t bytes, struct camera_frame_info *ret_info)
{
	const struct camera_format *format = camera_format_find(info->fourcc);
	bool jpeg = format && format->layout == CAMERA_MJPEG;
	if (!format || info->flags & CAMERA_FRAME_ERROR || info->width == 0 || info->height == 0 ||
		info->width % 2 || info->height % 2 || info->width > CAMERA_SIDE_MAX ||
		info->height > CAMERA_SIDE_MAX ||
		(!jpeg && bytes != camera_format_bytes(format, info->width, info->height)))
		return NULL;
	*ret_info = *info;
	ret_info->fourcc = CAMERA_FOURCC_NV12;
	ret_info->flags &= ~(CAMERA_FULL_RANGE | CAMERA_BT709);
	bool yuv = !camera_format_is_raw(format), full = jpeg || info->flags & CAMERA_FULL_RANGE,
	     other = info->flags & CAMERA_BT709 && !jpeg;
	if (format->layout == CAMERA_NV12 && !full && !other)
		return pixels;
	uint8_t *nv12 = have_room(&f->nv12, &f->nv12_room, camera_frame_bytes(ret_info));
	if (!convert(f, nv12, format, info, pixels, bytes))
		return NULL;
	if (yuv && full)
		to_limited_range(nv12, info->width, info->height);
	if (yuv && other)
		to_bt601(nv12, info->width, info->height);
	return nv12;
}

/* ---- stamps ---- */

int64_t frames_host_ns(uint32_t ticks_us, int64_t arrival_ns)
{
	int64_t arrival_us = arrival_ns / 1000;
	return (arrival_us + (int32_t)(ticks_us - (uint32_t)arrival_us)) * 1000;
}

int64_t frames_middle_ns(const struct camera_frame_info *info, double readout_us)
{
	int64_t half_ns = info->controls.exposure_100us * INT64_C(50000);
	return info->flags & CAMERA_STAMP_END ? -half_ns - (int64_t)(readout_us * 1000) : half_ns;
}
