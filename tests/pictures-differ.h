#ifndef TESTS_PICTURES_DIFFER_H
#define TESTS_PICTURES_DIFFER_H
/* How far two pictures of the same size are from each other, and both of them with the difference as files to look at. */
#include "render/draw.h"
#include <stdlib.h>

/* Pixels that differ by more are far off; of 255. */
#define FAR 8

struct difference {
	double mean, within;
	int most;
};

static struct difference differ(const struct picture_buffer *a, const struct picture_buffer *b)
{
	struct difference d = { 0 };
	size_t pixels = (size_t)a->width * a->height, within = 0;
	for (size_t i = 0; i < pixels; i++) {
		int most = 0;
		for (int k = 0; k < 3; k++) {
			int here = abs(a->rgba[i][k] - b->rgba[i][k]);
			d.mean += here;
			most = MAX(most, here);
		}
		within += most <= FAR;
		d.most = MAX(d.most, most);
	}
	d.mean /= 3.0 * (double)pixels;
	d.within = (double)within / (double)pixels;
	return d;
}

static void save(const struct picture_buffer *p, const char *name, const char *what)
{
	g_autoptr(GError) error = NULL;
	const char *programs = g_getenv("PLEINAIR_BIN");
	g_autofree char *file = g_strdup_printf("parity-%s-%s.png", name, what);
	g_autofree char *path =
		g_build_filename(programs ? programs : "build/bin", "..", "tests", file, NULL);
	if (picture_buffer_save(p, path, &error))
		g_test_message("see %s", path);
}

static void save_all(
	const struct picture_buffer *cpu, const struct picture_buffer *gles, const char *name)
{
	struct picture_buffer off = picture_buffer_new(cpu->width, cpu->height);
	for (size_t i = 0; i < (size_t)cpu->width * cpu->height; i++) {
		for (int k = 0; k < 3; k++)
			off.rgba[i][k] =
				(uint8_t)MIN(8 * abs(cpu->rgba[i][k] - gles->rgba[i][k]), 255);
		off.rgba[i][3] = 255;
	}
	save(cpu, name, "cpu");
	save(gles, name, "gles");
	save(&off, name, "difference");
	picture_buffer_clear(&off);
}

#endif
