#ifndef PROCESS_EXPORT_FORMAT_H
#define PROCESS_EXPORT_FORMAT_H
/* What a format's writer is given, and what it is. To add one, write its file and a row of export_formats. */
#include "process/export.h"
#include "process/scan-data.h"
#include <stdio.h>

/* A picture that came with an imported station. */
struct export_picture {
	char *path, *name; /* name NULL: none */
	char *kind;        /* as in scan.json */
	bool has_pose;
	struct pose pose; /* to the file's coordinates */
	int64_t width, height;
	double pixel_width, pixel_height, focal_m; /* 0: not known */
};

/* What a look through all points of a station told: of those that are written. */
struct export_survey {
	uint64_t points, left_out;
	double low_m[3], high_m[3]; /* as they are written */
	uint16_t intensity_least, intensity_most;
	uint8_t rgb_least[3], rgb_most[3];
	uint32_t row_least, row_most, column_least, column_most;
	bool has_intensity, has_colour, has_classes; /* any point that is not 0 */
	uint8_t return_most;
	uint8_t *kept; /* a bit a cell or point; NULL: all */
};

struct export_station {
	uint32_t number;
	enum scan_kind kind;
	uint32_t columns, rows;                        /* 0: none */
	uint64_t cells;                                /* or points, of a cloud */
	char *name;                                    /* for people */
	char *guid;                                    /* of the station, always the same */
	char *vendor, *model_name, *serial, *firmware; /* of the lidar; NULL: not known */
	char *source;                 /* of what file it was imported; NULL: recorded */
	double started_s, finished_s; /* seconds since 1970, NAN: not known */
	bool has_pose;
	struct pose pose; /* of the station's frame to the file's coordinates */
	GPtrArray *pictures;
	struct export_survey survey;
};

struct export_point {
	double at_m
		[3]; /* as the format has them: in the station's frame, or in the file's coordinates */
	uint16_t intensity;
	uint8_t rgb[3];
	uint8_t classification, return_number;
	bool is_point; /* else a cell without one */
	uint32_t row, column;
};

struct export_steps {
	uint64_t cells;       /* of all stations: what one pass goes through */
	uint64_t done;        /* in this pass */
	double before, share; /* of the work: what was done before this pass, what this one is */
	const char *doing;
};

struct export_job {
	const site *site;
	const struct export_format *format;
	const struct export_options *options;
	GPtrArray *stations; /* of struct export_station */
	bool one_grid;       /* the file is a single station with its grid, in its own frame */
	double origin_m[3];  /* of the site on a map */
	const char *site_name, *site_id;
	GPtrArray *notes;
	struct export_steps *steps; /* how far the work is */
};
static inline struct export_station *export_station_at(const struct export_job *j, guint i)
{
	return j->stations->pdata[i];
}
static inline bool export_is_merged(const struct export_job *j);

enum export_walk_order {
	EXPORT_WALK_POINTS,  /* points alone, row by row where there are rows */
	EXPORT_WALK_ROWS,    /* all cells of a grid, row by row */
	EXPORT_WALK_COLUMNS, /* all cells, column by column */
};

typedef struct export_writer export_writer; /* each format's own; it casts */
struct export_format {
	const char *name, *extension;
	bool merged;         /* all points in one frame */
	bool grids_only;     /* stations without a grid have no place in it */
	bool keeps_one_grid; /* merged, but for a single station with a grid */
	bool has_map;        /* coordinates of a map are exact in it */
	enum export_walk_order
		order; /* of stations with a grid; a file of one grid has EXPORT_WALK_ROWS */
	/* Of a file that is empty; all surveys are done. Writes what stands before the first station. */
	export_writer *(*open)(const struct export_job *j, FILE *file, GError **error);
	/* Then of each station these three. */
	bool (*begin)(export_writer *w, const struct export_station *s, GError **error);
	bool (*write)(export_writer *w, const struct export_point *p, size_t count, GError **error);
	bool (*end)(export_writer *w, GError **error);
	/* What stands behind the last one. Failures of the file itself need not be looked for. */
	bool (*finish)(export_writer *w, GError **error);
	void (*close)(export_writer *w); /* NULL is fine */
	/* Reads the file back, and compares it with the points that were to be written (export-verify.h). */
	bool (*verify)(const struct export_job *j, const char *path, GError **error);
	double (*resolution_m)(const struct export_job *j);
};
/* Ends with NULL. */
extern const struct export_format *const export_formats[];
extern const struct export_format export_e57, export_ptx, export_las, export_ply, export_pcd;

static inline bool export_is_merged(const struct export_job *j)
{
	return j->format->merged && !j->one_grid;
}

/* "{4F947749-...}" of the site, its scan (0: the site) and what it is for, the same in every export; caller frees. */
char *export_guid(const struct export_job *j, uint32_t number, const char *what);

/* ---- progress ---- */

/* Says how far the work is; false with G_IO_ERROR_CANCELLED: it is to stop. count: of cells or points that this pass went through since. */
bool export_step(const struct export_job *j, uint64_t count, GError **error);

#endif
