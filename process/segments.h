#ifndef PROCESS_SEGMENTS_H
#define PROCESS_SEGMENTS_H
/* The tree of segments of a site (Wegen et al. 2024, section 4.2; Xu & Chen 2004, section 3): the site, its classes, the things of a
 * class, their parts, and what a person has made of them. Points belong to leaves, each to exactly one. Numbers below
 * SEGMENT_FIRST are the site and its classes.
 *
 * A node keeps its number as long as it is, also when segments are found anew because a scan was added or a parameter changed:
 * what is the same by its points has the number that it had (segment-numbers.h). The number of what is gone is given to nothing
 * else: "next" is the first one that none ever had. Only when all SEGMENTS_MAX are used up, those that nothing has are given out
 * once more. Names go with the numbers (segment-names.h). Where there are no segments yet, numbers of both are in the order in
 * which things are found.
 *
 * On disk: SITE/segments/segments.json, a product like the labels beside it (scan-segments.h):
 *
 *     "schema": 1, "key": "...", "edits": "1 2 5", "next": 131
 *     "labels": [ { "scan": 1, "checksum": 2864434397 }, ... ]
 *     "segments": [ { "id": 19, "parent": 4, "class": "vegetation", "name": "Tree 4", "made_by": "rules", "found": 22,
 *                     "points": 81234, "low_m": [x,y,z], "high_m": [x,y,z], "area_m2": 41.2 }, ... ]
 *
 * "next", "labels" and "found" may be missing, as in files of before.
 *
 * One owner. Errors are those of manifest.h. */
#include "process/segment-class.h"
#include <glib.h>
#include <stdbool.h>

#define SEGMENT_NONE  0u /* of a cell: it has no point */
#define SEGMENT_SITE  1u
#define SEGMENT_FIRST 16u
#define SEGMENTS_MAX  65535u

/* The node of a class. */
static inline uint32_t segment_of_class(enum segment_class class)
{
	return 2 + (uint32_t) class;
}

struct segment {
	uint32_t id, parent; /* parent 0: the site */
	uint32_t
		found; /* its place in the order of finding, from SEGMENT_FIRST; 0: a person made it */
	enum segment_class class;
	char *name;                 /* "Tree 4" */
	char *made_by;              /* "rules", "labels", "model", "user" */
	uint64_t points;            /* with those of its children, as all that follows */
	double low_m[3], high_m[3]; /* box in the site; low > high: no point */
	double area_m2;             /* of surface, each counted once however many scans saw it */
};

/* The labels that belong to a tree. */
struct labels_checksum {
	uint32_t scan, checksum; /* of the section (scan-segments.h) */
};

typedef struct segments segments;
struct segments {
	GArray *nodes;  /* of struct segment, by id */
	char *key;      /* what it was made from */
	char *edits;    /* numbers of the changes that are in it (segment-edits.h) */
	uint32_t next;  /* no node ever had this number or a larger one */
	GArray *labels; /* of struct labels_checksum */
};

/* With the site and all classes, and nothing in them. */
segments *segments_new(void);
segments *segments_copy(const segments *s);
void segments_free(segments *s); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(segments, segments_free)
char *segments_path(const char *site_path); /* caller frees */
/* SITE/segments/automatic.json: as the computer found it, before people changed it; caller frees. */
char *segments_automatic_path(const char *site_path);
/* Refuses a tree that is none: unknown parents, circles, equal numbers. */
segments *segments_load(const char *site_path, GError **error);
segments *segments_load_file(const char *path, GError **error);
/* The same of a site of which there may be none yet: *ret is NULL then, without an error. */
bool segments_load_any(const char *site_path, segments **ret, GError **error);
bool segments_save(const segments *s, const char *site_path, GError **error);
bool segments_save_file(const segments *s, const char *path, GError **error);

/* NULL: none of this number. Pointers hold until a node is added or removed. */
struct segment *segments_find(const segments *s, uint32_t id);
/* The number that it gets; 0 when there are too many. Copies name. */
uint32_t segments_add(segments *s, uint32_t parent, const char *name, const char *made_by);
void segments_remove(segments *s, uint32_t id); /* one without children */
/* becomes: of each number up to SEGMENTS_MAX, another one for each that is there; those below SEGMENT_FIRST stay. */
void segments_renumber(segments *s, const uint16_t *becomes);
bool segments_is_leaf(const segments *s, uint32_t id);
/* Whether a is b or stands above it. */
bool segments_is_above(const segments *s, uint32_t a, uint32_t b);
/* The class of every number up to SEGMENTS_MAX, enum segment_class; of those that nothing has CLASS_OTHER. Caller frees. */
uint8_t *segments_classes(const segments *s);
/* Of the site's tree; *ret NULL, without an error: there is none yet. */
bool segments_classes_load(const char *site_path, uint8_t **ret, GError **error);
/* Another one when any class is another; 0 of NULL. */
uint32_t segments_classes_checksum(const uint8_t *leaf_class);
/* "Vegetation / Tree 4"; caller frees. */
char *segments_name(const segments *s, uint32_t id);

/* Of the labels of a scan, which it belongs to from then on. */
void segments_add_labels(segments *s, uint32_t scan, uint32_t checksum);
bool segments_has_labels(const segments *s, uint32_t scan, uint32_t checksum);

/* A point of a leaf: counts for all above it too. */
void segments_clear_sums(segments *s);
void segments_count(segments *s, uint32_t leaf, uint64_t points, const double low_m[3],
	const double high_m[3], double area_m2);

#endif
