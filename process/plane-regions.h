#ifndef PROCESS_PLANE_REGIONS_H
#define PROCESS_PLANE_REGIONS_H
/* The plane surfaces of a model, walls, floors, ground and roofs, as polygons with their colours: SITE/model/planes.regions, a product
 * file (product.h) beside the model that it was made from (pleinair-model(5)). What draws surfaces draws a polygon in place of its points.
 *
 * 1. Regions (plane-grow.h): in each leaf of buildings, terrain and structure, cubes of space whose points lie on one plane.
 * 2. Outlines (plane-outline.h, plane-straight.h): where its points' patches cover the plane; what was not seen stays open. Edges are
 *    straight, along the main directions where they nearly are, and on the line where two planes meet.
 * 3. Colours (plane-texture.h): means of its points, in linear light; small gaps are filled from around them.
 * 4. Which points it explains: those of its leaf that lie on it, as near as its noise has them. Others stay points.
 *
 * The same model gives the same bytes on any number of threads. */
#include "process/model.h"
#include "process/segment-class.h"

#define PLANE_REGIONS_KIND    "plane-regions"
#define PLANE_REGIONS_VERSION 3

struct plane_region {
	double origin_m[3]; /* in the site, where u = v = 0 */
	float u[3], v[3],
		normal[3]; /* unit; normal = u x v, towards where it was seen from; of what stands v is up */
	float thickness_m;      /* its points lie no farther from it */
	float noise_m;          /* root of their mean squared distance */
	float area_m2;          /* of the polygon */
	float texel_m;          /* edge of a texel */
	float low_m[2];         /* u v of the corner of the first texel */
	uint32_t width, height; /* of its texture, which holds all of the polygon */
	uint32_t first_ring,
		rings; /* one that is inside of one other is a hole: a place inside of an odd number of rings is of the polygon */
	uint32_t leaf;
	uint64_t first_texel; /* rows along u, the lowest v first */
	uint64_t points;      /* that it explains */
};
_Static_assert(sizeof(struct plane_region) == 120, "the file's own layout");

struct plane_ring {
	uint32_t first, count; /* of its vertices, at least three */
};

/* Const after it was made; any number of threads may read. */
typedef struct plane_regions plane_regions;
struct plane_regions {
	uint32_t count, rings, vertices;
	uint64_t texels, points; /* points: of the model */
	uint32_t classes;        /* segments_classes_checksum() of those that it was found with */
	const struct plane_region *region;
	const struct plane_ring *ring;
	const float (*vertex)[2]; /* u v, m */
	/* sRGB, 255; where nobody photographed it: the intensity, low byte first, 0, 0. */
	const uint8_t (*texel)[4];
	const uint8_t
		*explained; /* a bit for each point of the model, the first of a byte lowest */
	product *file;      /* NULL: memory of its own */
};
void plane_regions_free(plane_regions *r); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(plane_regions, plane_regions_free)

static inline bool plane_regions_explain(const plane_regions *r, uint64_t point)
{
	return r->explained[point / 8] >> point % 8 & 1;
}

/* Zero is the default of each. */
struct plane_options {
	float area_least_m2; /* 1: smaller ones are left out */
	float texel_m;       /* 0.01; larger where points are sparser, or the site is large */
	const uint8_t *
		leaf_class; /* enum segment_class of every number of a leaf; NULL: not known, all are looked at */
	/* 0..1 of the work; returns false to stop, and NULL is returned then, without an error. */
	bool (*progress)(double fraction, gpointer user_data);
	gpointer user_data;
};
plane_regions *plane_regions_find(const model *m, const struct plane_options *o, GError **error);

char *plane_regions_path(const char *site_path); /* SITE/model/planes.regions; caller frees */
bool plane_regions_save(const plane_regions *r, const model *of, const char *path, GError **error);
/* Checks that all of it belongs together. Errors are those of product.h. */
plane_regions *plane_regions_open(const char *path, GError **error);
/* Whether it was made from this very model. */
bool plane_regions_are_of(const plane_regions *r, const model *m);

#endif
