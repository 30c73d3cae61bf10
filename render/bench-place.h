#ifndef RENDER_BENCH_PLACE_H
#define RENDER_BENCH_PLACE_H
/* What benches of drawing draw: a person's site, or a simulated courtyard, scanned from BENCH_STATIONS places and processed. */
#include "process/bench-town.h"
#include "process/segments.h"
#include "render/scene.h"
#include "render/style.h"
#include "render/view-find.h"

struct bench_place_options {
	const char *site;   /* NULL: simulated */
	const char *preset; /* NULL: fine */
	uint64_t seed;
	/* Folder where the simulated site stays, and is taken from the next time; NULL: a temporary one. */
	const char *keep;
};

typedef struct bench_place bench_place;
struct bench_place {
	char *path;
	char *keep; /* NULL: simulated sites do not stay */
	char *work; /* a folder for files on the way; removed with all that is in it */
	site *site;
	model *model;
	segments *tree; /* NULL: there are none */
	GArray *stations;
	view_boxes *boxes;
	struct view_sources sources;
};
/* aspect: width by height of the pictures. Errors of scanning, pleinair process, opening. */
bench_place *bench_place_new(
	const struct bench_place_options *options, double aspect, GError **error);
void bench_place_free(bench_place *p); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(bench_place, bench_place_free)

/* A town of at least so many points, of blocks of this place: its path, which the caller frees. It stays where simulated sites stay. */
char *bench_place_town(
	const bench_place *p, double million_points, struct bench_town *ret, GError **error);

/* Its points, with its profile lines where it has some. */
scene *bench_place_scene(const bench_place *p, GError **error);

/* How a style of this name draws it. */
drawing *bench_place_drawing(const bench_place *p, const char *style_name, GError **error);

#endif
