#ifndef PROCESS_TWO_FACE_PATCH_H
#define PROCESS_TWO_FACE_PATCH_H
/* The beams of a scan, placed as the lidar is thought to sit, in patches of a few degrees of the sphere round the scanner: of each
 * patch the sums from which planes and their dependence on the unknowns follow. A patch is a window of directions, so the noise of
 * ranges cannot push a beam out of it and make a bias. Part of two-face.h; pure. */
#include "process/two-face.h"

/* Of a group that says something. */
#define PATCH_BEAMS_MIN 6

/* Where the lidar is thought to sit, and how late its stamps and the gear are. */
struct two_face_place {
	struct lidar_calibration lidar;
	double delay_s, slack_rad;
};

/* Front and back forth, front and back on the way back. */
enum { PATCH_GROUPS = 4 };

/* Sums over beams; places are from the patch's own origin. */
struct patch_sum {
	double n, x[3], xx[6], by[TWO_FACE_UNKNOWNS][3];
};
/* The direction of the plane that all groups have in common; its variance is of a small angle, rad^2. */
struct patch_plane {
	double normal[3], tilt_variance;
};
struct face_patch {
	double origin_m[3];
	struct patch_sum sum[PATCH_GROUPS];
	bool is_plane; /* enough beams, on a surface that is wider than it is rough */
	struct patch_plane plane;
};
struct face_patches {
	uint32_t count;
	struct face_patch *patch;
};
typedef struct face_patches face_patches;
/* Of every so many beams one; 1: all. */
face_patches *face_patches_new(
	const struct faces *f, const struct two_face_place *place, uint32_t every);
void face_patches_free(face_patches *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(face_patches, face_patches_free)

/* Means of one group of a plane, and how rough it is along the normal. false: too few beams. */
struct patch_group {
	double count, mean_m[3], rms_m, by[TWO_FACE_UNKNOWNS][3];
};
bool patch_group_of(const struct face_patch *p, int group, struct patch_group *ret);

/* Each beam of the scan that hit something, placed: where it ends in the scanner's frame, and the unit direction in which its range
 * runs. */
typedef void (*face_beam_func)(const double end_m[3], const double along[3], gpointer user_data);
void face_beams_place(const struct faces *f, const struct two_face_place *place,
	face_beam_func taken, gpointer user_data);

int patch_compare_doubles(gconstpointer a, gconstpointer b);

#endif
