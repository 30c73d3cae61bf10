#ifndef PROCESS_PROFILE_FACES_H
#define PROCESS_PROFILE_FACES_H
/* What a surface is like across a straight piece of an edge: all points around it, taken together along it, show a section through the
 * faces beside it, however few points each of them has. A moulding has several. */
#include "process/profile-pieces.h"
#include "process/profile-view.h"

/* Around a piece points are looked at within so many spacings of them. */
#define PROFILE_RADIUS_SPACINGS 8.0f
#define PROFILE_RADIUS_LEAST_M  0.15f
#define PROFILE_RADIUS_MOST_M   0.30f
/* Two faces are so far apart at least. */
#define PROFILE_APART_COS 0.92f /* 23 degrees */
#define PROFILE_FACES     24
#define PROFILE_SPANS     48
#define PROFILE_JOINTS    32
#define PROFILE_NO_FACE   255

struct profile_face {
	float normal[3]; /* in the frame: across, across, along */
	float off_m;     /* normal . place = off_m */
	float noise_m;
	uint32_t points;
	float along_information; /* profile-view.h */
};
/* A part of a face without gaps, beside the piece. */
struct profile_span {
	uint32_t face;
	float from_m, to_m;
};

/* Where two faces lie side by side, as a station sees them (profile-view.h). */
struct profile_joint {
	uint32_t face[2];
	struct profile_border border;
};

struct profile_section {
	struct profile_look look;
	struct profile_frame frame;
	GArray *near;     /* of struct profile_near */
	uint8_t *face_of; /* of each of these */
	float half_m;     /* of the piece's length: along goes from -half_m to half_m */
	float spacing_m, radius_m;
	bool is_guessed; /* nobody knows where some of it was seen from */
	struct profile_face face[PROFILE_FACES];
	uint32_t faces;
	struct profile_span span[PROFILE_SPANS];
	uint32_t spans;
	struct profile_joint joint[PROFILE_JOINTS];
	uint32_t joints;
};
/* s->look is set, and s->near an empty array of them, or one of before; clear it in the end. */
void profile_section_look(
	const profile_around *all, const struct profile_piece *p, struct profile_section *s);
void profile_section_clear(struct profile_section *s);

void profile_frame_of(const struct profile_piece *p, struct profile_frame *f);
bool profile_is_of(const struct profile_near *p, const struct profile_face *f);
/* Whether a face of the section is bent along it, by more than what edges may lie off. */
bool profile_section_is_bent(const struct profile_section *s, uint32_t face);
/* How far beside the piece a point of the face is, in it. */
float profile_beside(const struct profile_near *p, const struct profile_face *f);

#endif
