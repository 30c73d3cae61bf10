#ifndef PROCESS_VOXELS_H
#define PROCESS_VOXELS_H
/* Points of any number of scans summed up in cubes of space, those alone that hold some: what is asked of a surface at the scale
 * of decimetres is asked of these, however many points there are. The lattice is fixed in the site's frame.
 *
 * Filled by one thread; const after voxels_link, then any number of threads may read. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define VOXEL_NONE UINT32_MAX

/* Means over the points that were added. */
struct voxel {
	int32_t at[3]; /* in the lattice: from at * size_m on */
	uint32_t points;
	float place[3];  /* in the voxel, 0..1 */
	float normal[3]; /* mean of unit normals: as long as they agree */
	float towards
		[3]; /* the scanners, mean of unit vectors; 0 0 0: nobody knows where they stood */
	float error_m; /* of the plane fits */
	float size_m;  /* the least diameter of a patch: how far apart points are */
	float area_m2; /* of the surface in it, by the scan that shows the most of it; a sum */
	float rgb[3];  /* 0..1, sRGB */
	float coloured, intensity,
		late; /* shares: points with colour; 0..65535; points that are not the first return */
};

/* A point to be added; what is left 0 is not known. */
struct voxel_point {
	double at_m[3];
	float normal[3];  /* 0 0 0: none */
	float towards[3]; /* the scanner, unit; 0 0 0: not known */
	float error_m, size_m;
	float area_m2;      /* of the patch that it stands for */
	uint32_t scan;      /* points come scan by scan */
	const uint8_t *rgb; /* NULL: none */
	uint16_t intensity;
	bool is_late;
};

typedef struct voxels voxels;
struct voxels {
	double size_m;
	uint32_t count;
	struct voxel *voxel;
	/* After voxels_link: neighbours of voxel i are link[first_link[i] .. first_link[i + 1]). */
	uint32_t *first_link, *link;
	/* inside */
	uint32_t *slot, slots, room, last; /* last: the voxel that was asked for last */
	struct voxel_area *area;
};

/* Of a place in the lattice. */
static inline uint32_t voxel_hash(const int32_t at[3])
{
	uint64_t h = (uint32_t)at[0] * 0x9E3779B97F4A7C15u ^ (uint32_t)at[1] * 0xC2B2AE3D27D4EB4Fu ^
		     (uint32_t)at[2] * 0x165667B19E3779F9u;
	return (uint32_t)((h ^ h >> 29) * 0xBF58476D1CE4E5B9u >> 32);
}

voxels *voxels_new(double size_m);
void voxels_free(voxels *v); /* NULL is fine */
/* The voxel it went into; VOXEL_NONE: beyond the lattice, a hundred thousand km away. */
uint32_t voxels_add(voxels *v, const struct voxel_point *p);
/* Adds the sums of another, of the same size, of points of one scan, not finished either, as if its points came next. */
void voxels_merge(voxels *v, const voxels *from);
/* Sums become means, and voxels are put in an order that keeps neighbours near: indices of voxels_add are void. */
void voxels_finish(voxels *v);
/* Links every voxel to those around it: the 26 beside it, and, where points are sparser than voxels, those up to
 * gap_points patches away, at most VOXELS_REACH voxels. The same both ways. After voxels_finish. */
#define VOXELS_REACH 4
void voxels_link(voxels *v, double gap_points);

uint32_t voxels_find(const voxels *v, const int32_t at[3]);
uint32_t voxels_find_point(const voxels *v, const double at_m[3]);
/* last: what was found before, or VOXEL_NONE; points that come one after another often lie in the same. */
uint32_t voxels_find_point_after(const voxels *v, const double at_m[3], uint32_t last);
/* The voxel's mean point. */
static inline void voxel_point_m(const voxels *v, uint32_t i, double ret_m[3])
{
	for (int k = 0; k < 3; k++)
		ret_m[k] = (v->voxel[i].at[k] + (double)v->voxel[i].place[k]) * v->size_m;
}

#include <glib.h>
G_DEFINE_AUTOPTR_CLEANUP_FUNC(voxels, voxels_free)

#endif
