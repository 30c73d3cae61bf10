#ifndef RENDER_PAPER_TEXTURE_H
#define RENDER_PAPER_TEXTURE_H
/* A paper texture is the relief of a paper: heights that dry media rub off on and that light from
 * the side shows. It repeats without a seam both ways, so it covers a picture of any size. Made
 * here of noise with constant seeds: the same bytes on every run. Its mean is that of a plane, so
 * what it is multiplied into gets neither lighter nor darker.
 *
 * Const once made; then any thread may read it. */
#include "render/texels.h"

enum { PAPER_TEXTURE_SIDE = 512, PAPER_TEXTURE_MEAN = 128 };

enum paper_kind {
	PAPER_SMOOTH,    /* hot-pressed: hardly any relief */
	PAPER_CARTRIDGE, /* drawing paper: fine tooth */
	PAPER_ROUGH,     /* cold-pressed watercolour paper: dimples of the felt */
	PAPER_LAID,      /* wires of the mould close together, chains across them far apart */
	PAPER_CANVAS,    /* plain weave of uneven threads */
	PAPER_KINDS
};

struct paper_texture_kind {
	const char *name, *title;        /* in files and command lines; for people */
	float deviation;                 /* of the heights from their mean, 0..255 */
	float (*make)(float x, float y); /* height there, of any mean and scale; x, y in texels */
};
extern const struct paper_texture_kind paper_texture_kinds[PAPER_KINDS];

typedef struct paper_texture paper_texture;
struct paper_texture {
	char *name;      /* as asked for */
	uint32_t side;   /* PAPER_TEXTURE_SIDE, both ways */
	uint8_t *height; /* side x side, row by row; 255 is highest, the mean PAPER_TEXTURE_MEAN */
};

/* A kind by its name, or a PNG by its path: a name with a '/' or ending in ".png". Of a PNG light
 * is high; it is stretched to the square and its mean is shifted, and where it does not fit its
 * own other side a seam will show.
 * NULL: one sentence (G_FILE_ERROR): there is no such kind, listing those there are; the file is
 * missing, not a PNG, or above 4096 pixels a side. */
paper_texture *paper_texture_new(const char *name, GError **error);
void paper_texture_free(paper_texture *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(paper_texture, paper_texture_free)

#endif
