#ifndef TESTS_CLOUD_MADE_H
#define TESTS_CLOUD_MADE_H
/* Clouds made by tests, and those of files. */
#include "process/cloud.h"
#include "process/import.h"
#include <math.h>

#define DEGREE (G_PI / 180)

/* x, y, z one after another. */
struct made {
	GArray *xyz; /* of double */
	GRand *rand;
};

static inline struct made made_new(guint32 seed)
{
	return (struct made){ g_array_new(false, false, sizeof(double)),
		g_rand_new_with_seed(seed) };
}

static inline void made_clear(struct made *m)
{
	g_array_unref(m->xyz);
	g_rand_free(m->rand);
}

static inline void made_add(struct made *m, double x, double y, double z)
{
	double p[3] = { x, y, z };
	g_array_append_vals(m->xyz, p, 3);
}

static inline double made_normal(struct made *m, double sigma)
{
	double u = 1 - g_rand_double(m->rand), v = g_rand_double(m->rand);
	return sigma * sqrt(-2 * log(u)) * cos(2 * G_PI * v);
}

static inline struct cloud_view made_view(const struct made *m)
{
	return (struct cloud_view){ .first = m->xyz->data, .count = m->xyz->len / 3 };
}

static inline double *made_at(const struct made *m, size_t i)
{
	return &g_array_index(m->xyz, double, 3 * i);
}

static inline void made_move(struct made *m, const struct pose *p)
{
	for (size_t i = 0; i < m->xyz->len / 3; i++)
		pose_apply(p, made_at(m, i), made_at(m, i));
}

/* Every step-th point of the first scan of a file. */
static inline struct made made_from_file(
	const char *path, const struct import_format *f, size_t step)
{
	struct made m = made_new(1);
	g_autoptr(GError) error = NULL;
	g_autoptr(import_source) file = import_source_open(path, &error);
	g_assert_no_error(error);
	import_reader *r = f->open(file, NULL, &error);
	g_assert_no_error(error);
	const struct import_scan *scan;
	g_assert_cmpint(f->next_scan(r, &scan, &error), ==, IMPORT_SCAN);
	struct point_record block[1024];
	size_t at = 0;
	for (size_t count = 1; count;) {
		g_assert_true(f->read(r, block, G_N_ELEMENTS(block), &count, &error));
		for (size_t i = 0; i < count; i++)
			if (block[i].cell == CELL_MEASURED && at++ % step == 0)
				made_add(&m, block[i].x_m, block[i].y_m, block[i].z_m);
	}
	f->close(r);
	return m;
}

#endif
