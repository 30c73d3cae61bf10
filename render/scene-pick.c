#include "render/scene-pick.h"
#include "render/scene-pager.h"
#include "render/scene-planes.h"
#include <math.h>

/* Points so much behind the front one belong to the same surface: a part of its depth, and of their own spacing. */
#define BEHIND_PART 0.01

struct candidate {
	float depth_m, aside_px, reach_m;
	uint32_t chunk, point;
};

/* Whether a chunk's sphere may have something within radius_px. */
static bool may_be_near(const scene *s, const struct scene_chunk *c, const struct camera *cam,
	const double from_m[3], const double ray[3], double radius_px)
{
	double along = 0, square = 0, v, half = 0;
	for (int k = 0; k < 3; k++) {
		v = s->origin_m[k] + c->centre_m[k] - from_m[k];
		along += v * ray[k];
		square += v * v;
		half += (double)c->half_m[k] * c->half_m[k];
	}
	double reach = sqrt(half);
	if (along < -reach)
		return false;
	double aside = sqrt(fmax(square - along * along, 0));
	return aside <=
	       reach + 2 * radius_px / cam->focal_px * camera_scale_m(cam, fmax(along, 0) + reach);
}

static void look_at_chunk(const scene *s, uint32_t n, const struct camera *cam, const double px[2],
	double radius_px, GArray *found)
{
	const struct scene_chunk *c = &s->chunk[n];
	for (uint32_t i = 0; i < c->count; i++) {
		double place[3], at[2], depth;
		scene_position(s, c, i, place);
		if (!camera_project(cam, place, at, &depth) || depth > cam->far_m)
			continue;
		double disc_m = scene_disc(s, c->first + i) * (double)s->unit_m;
		double aside = hypot(at[0] - px[0], at[1] - px[1]);
		/* A point is as large as its patch, so that nothing is picked through near surface. */
		if (aside >
			fmax(radius_px, disc_m / 2 * cam->focal_px / camera_scale_m(cam, depth)))
			continue;
		struct candidate k = { (float)depth, (float)aside, (float)disc_m, n, i };
		g_array_append_val(found, k);
	}
}

static const struct candidate *front(const GArray *found)
{
	const struct candidate *ret = NULL;
	for (guint i = 0; i < found->len; i++) {
		const struct candidate *k = &g_array_index(found, struct candidate, i);
		if (!ret || k->depth_m < ret->depth_m)
			ret = k;
	}
	return ret;
}

/* Of the front surface: the leaf that most of its points have, and of it the point nearest to the place. */
static const struct candidate *choose(const scene *s, const GArray *found)
{
	const struct candidate *first = front(found), *best = NULL;
	g_autoptr(GHashTable) votes = g_hash_table_new(NULL, NULL);
	guint most = 0;
	uint32_t leaf = 0;
	double until = first->depth_m * (1 + BEHIND_PART) + 2 * first->reach_m;
	for (guint i = 0; i < found->len; i++) {
		const struct candidate *k = &g_array_index(found, struct candidate, i);
		if (k->depth_m > until)
			continue;
		gpointer key = GUINT_TO_POINTER(s->chunk[k->chunk].leaf);
		guint n = GPOINTER_TO_UINT(g_hash_table_lookup(votes, key)) + 1;
		g_hash_table_insert(votes, key, GUINT_TO_POINTER(n));
		if (n > most) {
			most = n;
			leaf = s->chunk[k->chunk].leaf;
		}
	}
	for (guint i = 0; i < found->len; i++) {
		const struct candidate *k = &g_array_index(found, struct candidate, i);
		if (k->depth_m <= until && s->chunk[k->chunk].leaf == leaf &&
			(!best || k->aside_px < best->aside_px))
			best = k;
	}
	return best;
}

static bool pick(const scene *s, const struct camera *c, const uint8_t *leaves, const double px[2],
	double radius_px, struct scene_picked *ret)
{
	double from_m[3], ray[3];
	g_autoptr(GArray) found = g_array_new(FALSE, FALSE, sizeof(struct candidate));
	camera_place(c, px, 0, from_m);
	camera_ray(c, px, ray);
	for (uint32_t n = 0; n < s->chunks; n++)
		if ((!leaves || leaves[s->chunk[n].leaf]) &&
			may_be_near(s, &s->chunk[n], c, from_m, ray, radius_px))
			look_at_chunk(s, n, c, px, radius_px, found);
	if (!found->len)
		return false;
	const struct candidate *k = choose(s, found);
	scene_position(s, &s->chunk[k->chunk], k->point, ret->place_m);
	ret->depth_m = k->depth_m;
	ret->leaf = s->chunk[k->chunk].leaf;
	return true;
}

bool scene_pick(const scene *s, const struct camera *c, const uint8_t *leaves, const double px[2],
	double radius_px, struct scene_picked *ret)
{
	scene_pager_hold(s);
	bool found = pick(s, c, leaves, px, radius_px, ret);
	scene_pager_release(s);
	return found;
}
