#ifndef TESTS_PLANES_MADE_H
#define TESTS_PLANES_MADE_H
/* A wall with a window above ground, as points with noise whose truth is known, and its plane regions beside its model. */
#include "process/plane-regions.h"
#include "tests/scene-made.h"

#define ROOM_APART_M 0.02
#define ROOM_NOISE_M 0.004
static const double room_wall_m[2] = { 4, 3 }, /* along x, up */
	room_window_m[2][2] = { { 1, 1.2 },
		{ 0.9, 2.1 } }; /* of the wall: x from..to, z from..to */
static const uint8_t room_wall_rgba[4] = { 200, 120, 60, 255 },
		     room_ground_rgba[4] = { 90, 100, 110, 255 };

static inline bool room_is_window(const double at_m[3])
{
	return at_m[0] > 100 + room_window_m[0][0] && at_m[0] < 102.2 &&
	       at_m[2] > 3 + room_window_m[1][0] && at_m[2] < 3 + room_window_m[1][1];
}

static inline double room_noise_m(GRand *r)
{
	double sum = 0;
	for (int n = 0; n < 12; n++)
		sum += g_rand_double(r);
	return ROOM_NOISE_M * (sum - 6);
}

/* From 100 200 3 on: ground 4 x 3 m, the wall behind it at y = 203, which faces -y; nothing where the window is. Behind the window a ball of
 * leaves. */
static inline made made_room(void)
{
	made m = made_new();
	struct made_plane ground = { .corner_m = { 100, 200, 3 },
		.a_m = { 4, 0, 0 },
		.b_m = { 0, 3, 0 },
		.apart_m = ROOM_APART_M,
		.order = MADE_JITTERED };
	struct made_plane wall = { .corner_m = { 100, 203, 3 },
		.a_m = { 4, 0, 0 },
		.b_m = { 0, 0, 3 },
		.apart_m = ROOM_APART_M,
		.order = MADE_JITTERED };
	static const double behind[3] = { 101.6, 204.5, 4.5 };
	memcpy(ground.rgba, room_ground_rgba, 4);
	memcpy(wall.rgba, room_wall_rgba, 4);
	made_add_plane(&m, &ground);
	made_add_plane(&m, &wall);
	made_add_ball(&m, behind, 0.5, 4000, MADE_LEAF + 1);
	guint left = 0;
	struct made_point *p = (struct made_point *)(void *)m.points->data;
	for (guint n = 0; n < m.points->len; n++) {
		if (p[n].leaf == MADE_LEAF && p[n].normal[1] != 0 && room_is_window(p[n].at_m))
			continue;
		p[left] = p[n];
		double noise_m = room_noise_m(m.chance);
		for (int k = 0; k < 3; k++)
			p[left].at_m[k] += noise_m * (double)p[left].normal[k];
		left++;
	}
	g_array_set_size(m.points, left);
	return m;
}

static inline plane_regions *made_find_planes(const model *m)
{
	g_autoptr(GError) error = NULL;
	g_autofree uint8_t *leaf_class = g_malloc0(SEGMENTS_MAX + 1);
	leaf_class[MADE_LEAF] = CLASS_BUILDING;
	leaf_class[MADE_LEAF + 1] = CLASS_VEGETATION;
	struct plane_options o = { .leaf_class = leaf_class };
	plane_regions *r = plane_regions_find(m, &o, &error);
	g_assert_no_error(error);
	return r;
}

/* The model's file, its planes' beside it, and the scene of both. */
static inline const scene *made_read_planes(made *m)
{
	g_autoptr(GError) error = NULL;
	made_find_folder(m);
	made_write_to(m, m->path);
	m->model = model_open_file(m->path, &error);
	g_assert_no_error(error);
	g_autoptr(plane_regions) r = made_find_planes(m->model);
	g_autofree char *path = g_build_filename(m->folder, "planes.regions", NULL);
	g_assert_true(plane_regions_save(r, m->model, path, &error));
	m->scene = scene_new(m->model, &error);
	g_assert_no_error(error);
	return m->scene;
}

#endif
