#ifndef PROCESS_E57_TREE_H
#define PROCESS_E57_TREE_H
/* What the XML of an E57 file (e57.h) says, as far as it is of use here. What it has besides, extensions too, is passed over. Plain
 * values, owned by the tree. */
#include "process/e57-pages.h"

enum e57_kind { E57_INTEGER, E57_SCALED, E57_FLOAT32, E57_FLOAT64, E57_STRING };

/* A field of a vector's records. */
struct e57_field {
	char *name; /* without the prefix of an extension */
	bool is_extension;
	enum e57_kind kind;
	int64_t minimum, maximum; /* of the whole numbers */
	double scale, offset;     /* what stands there is whole * scale + offset */
	double least, most; /* of what stands there, as the XML says; -inf and inf: it does not */
};

struct e57_limits {
	bool given;
	double least, most;
};

struct e57_scan {
	char *guid, *name; /* NULL: none */
	bool has_pose;
	struct pose pose;
	struct e57_limits intensity, colour[3];
	struct e57_limits rows, columns; /* of its grid; one row alone counts as not given */
	bool has_points;
	char *codec;      /* that packs them and is not of the standard; NULL: none */
	uint64_t section; /* logical offset of the vector */
	uint64_t count;   /* of records */
	GArray *fields;   /* of struct e57_field, in the order of the streams */
};

#define E57_NO_SCAN UINT_MAX

/* A picture in the file. */
struct e57_image {
	unsigned number;       /* in the file, from 1 */
	char *name;            /* NULL: none */
	unsigned scan;         /* that it belongs to, from 0; E57_NO_SCAN: none of these */
	const char *kind;      /* "spherical", "pinhole", "cylindrical" or "visual reference" */
	const char *extension; /* "jpg" or "png" */
	bool has_pose;
	struct pose pose;
	uint64_t section, bytes;          /* logical offset of the blob; of the picture */
	int64_t width, height;            /* as the XML says; 0: it does not */
	double pixel_width, pixel_height; /* rad, or m at the pinhole; 0: none */
	double focal_m;                   /* 0: none */
};

typedef struct e57_tree e57_tree;
struct e57_tree {
	GPtrArray *scans, *images; /* of struct e57_scan, e57_image */
	GPtrArray *passed_over;    /* of char: what of the file cannot be used, a few words each */
};
e57_tree *e57_tree_read(e57_pages *pages, import_source *file, GError **error);
void e57_tree_free(e57_tree *t); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(e57_tree, e57_tree_free)

#endif
