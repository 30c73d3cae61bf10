#ifndef RENDER_OUTPUT_H
#define RENDER_OUTPUT_H
/* Where drawn frames go, by the end of the file's name: a picture (.png, .tif, .tiff), a page of shapes (.svg, .pdf), or a film (.mp4,
 * .webm). Pictures and pages of several frames are numbered, FILE-0000.png and so on; a film is one file. Pictures may be of any size:
 * they are drawn in windows (poster.h) and written as they come.
 *
 * One thread. */
#include "render/film.h"
#include "render/page-legend.h"
#include "render/page-size.h"
#include "render/poster.h"

enum output_kind { OUTPUT_PICTURE, OUTPUT_SVG, OUTPUT_PDF, OUTPUT_FILM, OUTPUT_KINDS };
/* OUTPUT_KINDS: none of these. */
enum output_kind output_kind_of(const char *path);
extern const char output_endings[]; /* for people */
static inline bool output_is_page(enum output_kind kind)
{
	return kind == OUTPUT_SVG || kind == OUTPUT_PDF;
}

struct output {
	enum output_kind kind;
	const char *path; /* these are the caller's */
	const char *title;
	const segments *tree;
	struct page_size size;
	uint32_t supersample;      /* frames are so many times as large */
	bool numbered, has_paper;  /* paper: of pages */
	const page_legend *legend; /* NULL: none; of pages and of pictures on paper */
	double fps;
	/* NULL, or as struct poster_desc has it, of a picture. */
	bool (*going)(void *data, double part, GError **error);
	void *data;
	/* Its own; 0 at first. */
	struct picture_buffer large;
	draw_room *room;
	film *film;
};
/* Zero memory with what is the caller's filled in is an output; clear it in the end. A film that is not finished is removed. */
void output_clear(struct output *o);
char *output_file(const struct output *o, uint32_t number); /* of that frame; caller frees */
/* The camera to make the frame of this output with, for those of pictures need not be as large as the picture: they show all of it in
 * windows. */
struct camera output_first_camera(const struct output *o, const struct camera *c);
/* Draws what the camera shows, with the painter unless it is a page, and writes it. The frame is of the camera, or of a window of it. */
bool output_add(struct output *o, painter *p, frame *f, const struct camera *c, uint32_t number,
	struct draw_times *ret_times, GError **error);
/* After the last one. */
bool output_finish(struct output *o, GError **error);

#endif
