#include "process/segment-things.h"
#include "process/components.h"
#include "process/single-trees.h"
#include <gio/gio.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define PART_AREA_M2 4.0
/* Alone in the air. */
#define STRAY_POINTS 3u
#define STRAY_M      0.5f

static const char *const rest_names[SEGMENT_CLASSES] = { "Stray points", "Small parts",
	"Undergrowth", "Ground", "Small structures", "Water" };
static const char *const thing_names[SEGMENT_CLASSES] = { "Thing", "Building", "Tree", "Ground",
	"Structure", "Water" };

void segment_things_clear(struct segment_things *t)
{
	g_free(t->leaf_of_voxel);
	g_free(t->leaf_of_surfel);
	g_free(t->class_of_leaf);
}

bool segment_things_is_rest(const struct segment *node)
{
	return node->parent == segment_of_class(node->class) &&
	       strcmp(node->name, rest_names[node->class]) == 0;
}

struct maker {
	struct segment_things *t;
	const struct classify_input *in;
	const voxels *v;
	uint8_t *class;
	segments *into;
	uint32_t points_min;
	GError **error;
};

/* 0 and an error: there are too many. */
static uint16_t add_leaf(struct maker *m, uint32_t parent, const char *name)
{
	uint32_t id = segments_add(m->into, parent, name, "rules");
	if (!id && m->error && !*m->error)
		g_set_error(m->error, G_IO_ERROR, G_IO_ERROR_NO_SPACE,
			"there are more than %u things; ask for larger gaps or more points in each",
			SEGMENTS_MAX - SEGMENT_FIRST);
	if (id)
		m->t->class_of_leaf[id] = (uint8_t)segments_find(m->into, parent)->class;
	return (uint16_t)id;
}

/* ---- strays ---- */

static void find_strays(struct maker *m)
{
	g_autoptr(components) c = components_find(m->v, NULL, 0);
	for (uint32_t i = 0; i < m->v->count; i++)
		if (c->component[c->of[i]].points <= STRAY_POINTS && m->in->height_m[i] > STRAY_M)
			m->class[i] = CLASS_OTHER;
}

/* ---- what hangs together ---- */

struct ranked {
	uint32_t points, index;
};

static int by_points(const void *a, const void *b)
{
	const struct ranked *x = a, *y = b;
	int by = (x->points < y->points) - (x->points > y->points);
	return by ? by : (x->index > y->index) - (x->index < y->index);
}

/* The largest first. */
static struct ranked *rank(const uint32_t *points, uint32_t count)
{
	struct ranked *r = g_new(struct ranked, count + 1);
	for (uint32_t k = 0; k < count; k++)
		r[k] = (struct ranked){ points[k], k };
	qsort(r, count, sizeof *r, by_points);
	return r;
}

/* Leaves of things that are told by a number per voxel; leaf[k] stays 0 for what is too small. */
static bool add_things(struct maker *m, enum segment_class class, const char *name,
	const uint32_t *points, uint32_t count, uint16_t *ret_leaf)
{
	g_autofree struct ranked *order = rank(points, count);
	for (uint32_t k = 0; k < count && order[k].points >= m->points_min; k++) {
		g_autofree char *numbered = g_strdup_printf("%s %u", name, k + 1);
		if (!(ret_leaf[order[k].index] = add_leaf(m, segment_of_class(class), numbered)))
			return false;
	}
	return true;
}

static components *components_of_class(const struct maker *m, enum segment_class class)
{
	g_autofree uint8_t *kind = g_new(uint8_t, m->v->count + 1);
	for (uint32_t i = 0; i < m->v->count; i++)
		kind[i] = m->class[i] == class;
	return components_find(m->v, kind, 0);
}

static uint32_t *points_of(const components *c)
{
	uint32_t *points = g_new(uint32_t, c->count + 1);
	for (uint32_t k = 0; k < c->count; k++)
		points[k] = c->component[k].points;
	return points;
}

static bool find_components(struct maker *m, enum segment_class class)
{
	g_autoptr(components) c = components_of_class(m, class);
	g_autofree uint32_t *points = points_of(c);
	g_autofree uint16_t *leaf = g_new0(uint16_t, c->count + 1);
	if (!add_things(m, class, thing_names[class], points, c->count, leaf))
		return false;
	for (uint32_t i = 0; i < m->v->count; i++)
		if (c->of[i] != VOXEL_NONE && leaf[c->of[i]])
			m->t->leaf_of_voxel[i] = leaf[c->of[i]];
	return true;
}

/* ---- plants ---- */

static bool find_plants(struct maker *m)
{
	g_autofree uint8_t *is_plant = g_new(uint8_t, m->v->count + 1);
	for (uint32_t i = 0; i < m->v->count; i++)
		is_plant[i] = m->class[i] == CLASS_VEGETATION;
	struct single_trees trees =
		single_trees_find(m->v, is_plant, m->in->height_m, m->points_min / 2);
	g_autofree uint32_t *of = trees.of;
	g_autofree uint32_t *points = g_new0(uint32_t, trees.count + 1);
	g_autofree uint16_t *leaf = g_new0(uint16_t, trees.count + 1);
	for (uint32_t i = 0; i < m->v->count; i++)
		if (of[i] != TREE_NONE)
			points[of[i]] += m->v->voxel[i].points;
	if (!add_things(m, CLASS_VEGETATION, "Tree", points, trees.trees, leaf) ||
		!add_things(m, CLASS_VEGETATION, "Bush", points + trees.trees,
			trees.count - trees.trees, leaf + trees.trees))
		return false;
	for (uint32_t i = 0; i < m->v->count; i++)
		if (of[i] != TREE_NONE && leaf[of[i]])
			m->t->leaf_of_voxel[i] = leaf[of[i]];
	return true;
}

/* ---- buildings ---- */

/* The component that most of each large region is in; VOXEL_NONE: in none. */
static uint32_t *building_of_regions(const struct maker *m, const components *c)
{
	const smooth_regions *r = m->in->regions;
	uint32_t *of = g_new(uint32_t, r->count + 1);
	g_autofree uint32_t *votes = g_new0(uint32_t, r->count + 1);
	memset(of, 0xFF, r->count * sizeof *of);
	/* a majority vote in one pass (Boyer and Moore 1991): most of a region is in one building anyway */
	for (uint32_t i = 0; i < m->v->count; i++) {
		uint32_t k = r->of[i];
		if (k == VOXEL_NONE || c->of[i] == VOXEL_NONE)
			continue;
		if (!votes[k])
			of[k] = c->of[i];
		votes[k] += of[k] == c->of[i] ? 1 : (uint32_t)-1;
	}
	return of;
}

static const char *part_name(const struct smooth_region *r)
{
	double length = sqrt(r->normal[0] * r->normal[0] + r->normal[1] * r->normal[1] +
			     r->normal[2] * r->normal[2]);
	double up = length > 0 ? r->normal[2] / length : 0;
	return up > 0.35 ? "Roof" : up < -0.7 ? "Ceiling" : "Wall";
}

/* Parts of buildings; the leaf of a building becomes that of its details. */
static bool add_parts(struct maker *m, const components *c, uint16_t *leaf, uint16_t *ret_part)
{
	const smooth_regions *r = m->in->regions;
	g_autofree uint32_t *building = building_of_regions(m, c);
	g_autofree uint32_t *size = g_new(uint32_t, r->count + 1);
	g_autofree uint32_t *parts = g_new0(uint32_t, c->count + 1);
	for (uint32_t k = 0; k < r->count; k++)
		size[k] = r->region[k].voxels;
	g_autofree struct ranked *order = rank(size, r->count);
	for (uint32_t n = 0; n < r->count; n++) {
		uint32_t k = order[n].index, b = building[k];
		if (size[k] * m->v->size_m * m->v->size_m < PART_AREA_M2)
			break;
		if (b == VOXEL_NONE || !leaf[b])
			continue;
		g_autofree char *name =
			g_strdup_printf("%s %u", part_name(&r->region[k]), ++parts[b]);
		if (!(ret_part[k] = add_leaf(m, leaf[b], name)))
			return false;
	}
	for (uint32_t b = 0; b < c->count; b++)
		if (parts[b] && !(leaf[b] = add_leaf(m, leaf[b], "Details")))
			return false;
	return true;
}

static bool find_buildings(struct maker *m)
{
	g_autoptr(components) c = components_of_class(m, CLASS_BUILDING);
	g_autofree uint32_t *points = points_of(c);
	g_autofree uint16_t *leaf = g_new0(uint16_t, c->count + 1);
	g_autofree uint16_t *part = g_new0(uint16_t, m->in->regions->count + 1);
	if (!add_things(m, CLASS_BUILDING, "Building", points, c->count, leaf) ||
		!add_parts(m, c, leaf, part))
		return false;
	for (uint32_t i = 0; i < m->v->count; i++) {
		uint32_t k = m->in->regions->of[i];
		if (m->class[i] != CLASS_BUILDING)
			continue;
		if (k != VOXEL_NONE && part[k])
			m->t->leaf_of_voxel[i] = part[k];
		else if (leaf[c->of[i]])
			m->t->leaf_of_voxel[i] = leaf[c->of[i]];
	}
	return true;
}

/* ---- all of them ---- */

static bool add_rests(struct maker *m)
{
	for (int class = 0; class < SEGMENT_CLASSES; class ++)
		if (!(m->t->rest[class] = add_leaf(
			      m, segment_of_class((enum segment_class) class), rest_names[class])))
			return false;
	for (uint32_t i = 0; i < m->v->count; i++)
		m->t->leaf_of_voxel[i] = m->t->rest[m->class[i]];
	for (uint32_t i = 0; i < ground_surfels(m->in->ground)->count; i++)
		m->t->leaf_of_surfel[i] = m->t->rest[m->in->ground_class[i]];
	return true;
}

/* At the foot of a wall, a surfel may be too little of a floor to walk on; what lies in it is ground all the same. */
static uint16_t leaf_of_area(const struct maker *m, uint32_t surfel)
{
	const ground *g = m->in->ground;
	double at[3];
	if (ground_is(g, surfel))
		return m->t->leaf_of_surfel[surfel];
	voxel_point_m(ground_surfels(g), surfel, at);
	uint32_t near = ground_surfel(g, at);
	return near != VOXEL_NONE && fabsf(ground_height_m(g, at)) < m->in->ground_m
		       ? m->t->leaf_of_surfel[near]
		       : SEGMENT_NONE;
}

static void sum_areas(const struct maker *m)
{
	static const double low[3] = { INFINITY, INFINITY, INFINITY },
			    high[3] = { -INFINITY, -INFINITY, -INFINITY };
	const voxels *surfels = ground_surfels(m->in->ground);
	g_autofree double *area = g_new0(double, SEGMENTS_MAX + 1);
	for (uint32_t i = 0; i < m->v->count; i++)
		area[m->t->leaf_of_voxel[i]] += m->v->voxel[i].area_m2;
	for (uint32_t i = 0; i < surfels->count; i++)
		area[leaf_of_area(m, i)] += surfels->voxel[i].area_m2;
	area[SEGMENT_NONE] = 0;
	for (uint32_t leaf = 0; leaf <= SEGMENTS_MAX; leaf++)
		if (area[leaf] > 0)
			segments_count(m->into, leaf, 0, low, high, area[leaf]);
}

bool segment_things_find(struct segment_things *t, const struct classify_input *in,
	const uint8_t *class, uint32_t points_min, segments *into, GError **error)
{
	g_autofree uint8_t *own = g_memdup2(class, in->voxels->count + 1);
	struct maker m = { t, in, in->voxels, own, into, points_min, error };
	t->leaf_of_voxel = g_new0(uint16_t, in->voxels->count + 1);
	t->leaf_of_surfel = g_new0(uint16_t, ground_surfels(in->ground)->count + 1);
	t->class_of_leaf = g_new0(uint8_t, SEGMENTS_MAX + 1);
	find_strays(&m);
	if (!add_rests(&m) || !find_buildings(&m) || !find_plants(&m) ||
		!find_components(&m, CLASS_STRUCTURE) || !find_components(&m, CLASS_WATER) ||
		!find_components(&m, CLASS_OTHER))
		return false;
	sum_areas(&m);
	return true;
}
