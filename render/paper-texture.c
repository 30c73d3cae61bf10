#include "render/paper-texture.h"
#include "render/grain.h"
#include <string.h>

enum { SIDE = PAPER_TEXTURE_SIDE, TEXELS = SIDE * SIDE };

/* ---- papers ---- */

/* Noise of so many cells across the side, which makes it fit its other side: -1..1. */
static float relief(float x, float y, int columns, int rows, uint32_t seed)
{
	return grain_noise(x * (float)columns / SIDE, y * (float)rows / SIDE, columns, rows, seed);
}

/* Fibres that lie this way and that: ridges of stretched noise. */
static float fibres(float x, float y, int fine, uint32_t seed)
{
	float across = fabsf(relief(x, y, fine, fine / 4, seed)),
	      down = fabsf(relief(x, y, fine / 4, fine, seed + 1));
	return MIN(across, down);
}

static float smooth_paper(float x, float y)
{
	return relief(x, y, 24, 24, 1) + 0.6f * relief(x, y, 96, 96, 2) -
	       1.5f * fibres(x, y, 128, 3);
}

static float cartridge_paper(float x, float y)
{
	return relief(x, y, 150, 150, 11) + 0.7f * relief(x, y, 80, 80, 12) +
	       0.25f * relief(x, y, 20, 20, 13) - 0.8f * fibres(x, y, 180, 14);
}

/* How far the nearest of scattered points is, one in each of cells x cells: 0..1 and a little
 * more. */
static float nearest(float x, float y, int cells, uint32_t seed)
{
	float u = x * (float)cells / SIDE, v = y * (float)cells / SIDE, best = 4;
	int column = grain_floor(u), row = grain_floor(v);
	for (int j = row - 1; j <= row + 1; j++)
		for (int i = column - 1; i <= column + 1; i++) {
			uint32_t h = grain_hash((uint32_t)grain_wrap(i, cells),
				(uint32_t)grain_wrap(j, cells), seed);
			float dx = (float)i + (float)(h & 0xffff) * 0x1p-16f - u,
			      dy = (float)j + (float)(h >> 16) * 0x1p-16f - v;
			float d2 = dx * dx + dy * dy;
			best = MIN(best, d2);
		}
	return sqrtf(best);
}

/* The felt presses round dimples, one beside the other and of different depth, which leaves soft
 * ridges between them. */
static float rough_paper(float x, float y)
{
	float bend_x = 6 * relief(x, y, 34, 34, 21), bend_y = 6 * relief(x, y, 34, 34, 22);
	float dimple = nearest(x + bend_x, y + bend_y, 36, 23);
	return 0.75f * MIN(dimple, 0.9f) + 0.5f * relief(x + bend_x, y + bend_y, 44, 44, 24) +
	       0.12f * relief(x, y, 130, 130, 25) + 0.15f * relief(x, y, 11, 11, 26);
}

/* Wires leave furrows, chains broader and darker ones; the pulp between them is cloudy. */
static float laid_paper(float x, float y)
{
	enum { WIRES = 86, CHAINS = 5 };
	float sway = 1.3f * relief(x, y, 6, 10, 31);
	float wire = cosf(2 * (float)M_PI * WIRES * (y + sway) / SIDE);
	float from_chain = (x + 2.5f * relief(x, y, 4, 12, 32)) * CHAINS / SIDE;
	from_chain = fabsf(from_chain - (float)grain_floor(from_chain) - 0.5f) * SIDE / CHAINS;
	float uneven = 1 + 0.9f * relief(x, y, 22, 43, 33);
	return 0.5f * wire * uneven - 0.9f * expf(-from_chain * from_chain / 12) +
	       0.55f * relief(x, y, 110, 110, 34) + 0.35f * relief(x, y, 14, 14, 35);
}

/* A thread is a round bar that rises where it goes over the other and dips where it goes under;
 * thick or thin, each for itself. Both arguments 0..1 within the crossing. */
static float thread(float across, float along, float thickness, bool over)
{
	float off = (2 * across - 1) / thickness, bar = 1 - off * off;
	float wave = sinf((float)M_PI * along) * (over ? 1.0f : -1.0f);
	return bar > 0 ? 0.8f * sqrtf(bar) + 0.6f * wave : -0.6f;
}

static float canvas(float x, float y)
{
	enum { THREADS = 48 };
	float u = (x + 1.5f * relief(x, y, 7, 19, 41)) * THREADS / SIDE,
	      v = (y + 1.5f * relief(x, y, 19, 7, 42)) * THREADS / SIDE;
	int column = grain_floor(u), row = grain_floor(v);
	bool warp_over = (column + row) & 1;
	float in_x = u - (float)column, in_y = v - (float)row;
	float warp_thickness = 0.85f + 0.3f * relief(x, y, THREADS, 5, 43),
	      weft_thickness = 0.85f + 0.3f * relief(x, y, 5, THREADS, 44);
	float warp = thread(in_x, in_y, warp_thickness, warp_over),
	      weft = thread(in_y, in_x, weft_thickness, !warp_over);
	return MAX(warp, weft) + 0.25f * relief(x, y, 120, 120, 45) + 0.2f * relief(x, y, 9, 9, 46);
}

const struct paper_texture_kind paper_texture_kinds[PAPER_KINDS] = {
	[PAPER_SMOOTH] = { "smooth", "Smooth", 5, smooth_paper },
	[PAPER_CARTRIDGE] = { "cartridge", "Cartridge", 20, cartridge_paper },
	[PAPER_ROUGH] = { "rough", "Rough, cold-pressed", 38, rough_paper },
	[PAPER_LAID] = { "laid", "Laid", 22, laid_paper },
	[PAPER_CANVAS] = { "canvas", "Canvas", 32, canvas },
};

/* ---- heights ---- */

static double mean_of(const float *height)
{
	double sum = 0;
	for (int i = 0; i < TEXELS; i++)
		sum += height[i];
	return sum / TEXELS;
}

static double deviation_of(const float *height, double mean)
{
	double sum = 0;
	for (int i = 0; i < TEXELS; i++)
		sum += (height[i] - mean) * (height[i] - mean);
	return sqrt(sum / TEXELS);
}

/* Scales about the mean, which what is cut off at the ends shifts: it is brought back until it
 * stays. */
static void round_heights(const float *height, double scale, uint8_t *out)
{
	double mean = mean_of(height), shift = PAPER_TEXTURE_MEAN;
	for (int turn = 0; turn < 8; turn++) {
		for (int i = 0; i < TEXELS; i++) {
			float h = (float)((height[i] - mean) * scale + shift);
			out[i] = (uint8_t)lrintf(CLAMP(h, 0.0f, 255.0f));
		}
		double off = PAPER_TEXTURE_MEAN - texels_mean(out, TEXELS);
		if (fabs(off) < 0.02)
			return;
		shift += off;
	}
}

static paper_texture *paper_of(const char *name)
{
	paper_texture *p = g_new0(paper_texture, 1);
	*p = (paper_texture){ g_strdup(name), SIDE, g_malloc(TEXELS) };
	return p;
}

void paper_texture_free(paper_texture *p)
{
	if (!p)
		return;
	g_free(p->name);
	g_free(p->height);
	g_free(p);
}

static paper_texture *make(const struct paper_texture_kind *kind)
{
	paper_texture *p = paper_of(kind->name);
	g_autofree float *height = g_new(float, TEXELS);
	for (int y = 0; y < SIDE; y++)
		for (int x = 0; x < SIDE; x++)
			height[y * SIDE + x] = kind->make((float)x + 0.5f, (float)y + 0.5f);
	round_heights(height, kind->deviation / deviation_of(height, mean_of(height)), p->height);
	return p;
}

static paper_texture *load(const char *path, GError **error)
{
	uint32_t width, rows;
	g_autofree uint8_t *light = texels_read_png(path, TEXELS_LIGHT, &width, &rows, error);
	if (!light)
		return NULL;
	paper_texture *p = paper_of(path);
	texels_scale(light, width, rows, p->height, SIDE, SIDE);
	g_autofree float *height = g_new(float, TEXELS);
	for (int i = 0; i < TEXELS; i++)
		height[i] = p->height[i];
	round_heights(height, 1, p->height);
	return p;
}

paper_texture *paper_texture_new(const char *name, GError **error)
{
	if (texels_is_path(name))
		return load(name, error);
	g_autoptr(GString) known = g_string_new(NULL);
	for (int k = 0; k < PAPER_KINDS; k++) {
		if (strcmp(name, paper_texture_kinds[k].name) == 0)
			return make(&paper_texture_kinds[k]);
		g_string_append_printf(known, "%s, ", paper_texture_kinds[k].name);
	}
	g_set_error(error, G_FILE_ERROR, G_FILE_ERROR_NOENT,
		"there is no paper '%s': %sor the path of a PNG", name, known->str);
	return NULL;
}
