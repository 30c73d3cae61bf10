#ifndef PROCESS_POSE_H
#define PROCESS_POSE_H
/* A rigid motion: takes points of one frame to another, y = rotation * x + translation. The pose of a scan takes its
 * scanner frame to the site's; a pose between scans B and A takes B's scanner frame to A's. Plain values; all functions are
 * pure. */
#include <stdbool.h>

struct pose {
	double rotation[3][3];
	double translation_m[3];
};

#define POSE_IDENTITY ((struct pose){ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } }, { 0, 0, 0 } })

void pose_apply(
	const struct pose *p, const double point_m[3], double ret_m[3]); /* may be in place */
void pose_rotate(
	const struct pose *p, const double direction[3], double ret[3]); /* may be in place */
struct pose pose_compose(
	const struct pose *second, const struct pose *first); /* first, then second */
struct pose pose_inverse(const struct pose *p);
/* The motion from one pose to the other, inverse(from) then to: how they differ. */
struct pose pose_between(const struct pose *from, const struct pose *to);
double pose_angle_rad(const struct pose *p);  /* of its rotation, exact also near 0 */
double pose_distance_m(const struct pose *p); /* of its translation */
/* Heading of the rotation about z, clockwise seen from above, -pi..pi. */
double pose_yaw_rad(const struct pose *p);
struct pose pose_from_yaw(double yaw_rad, const double translation_m[3]);
/* Exponential of a twist (rotation vector in rad, then translation in m), applied from the left: exp(twist) * p. The
 * translation part is added as it is (no coupling). */
struct pose pose_perturb(const struct pose *p, const double twist[6]);
/* The twist with pose_perturb(from, twist) = to. */
void pose_difference(const struct pose *from, const struct pose *to, double ret_twist[6]);
/* Removes what rounding has done to the rotation. */
void pose_orthonormalise(struct pose *p);
/* Whether the rotation is one, to within tolerance, and all is finite. */
bool pose_is_rigid(const struct pose *p, double tolerance);

#endif
