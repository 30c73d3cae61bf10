#include "process/segmentation.h"
#include "process/classify.h"
#include "process/ground.h"
#include "process/plinth.h"
#include "process/segment-things.h"
#include "process/voxel-shape.h"
#include "process/water.h"
#include <gio/gio.h>
#include <string.h>

#define GAP_LEAST_M 0.15
/* Of clouds: this many patches. */
#define GAP_PATCHES 3.5
#define GAP_POINTS  1.6 /* between voxels, where points are sparser than these */
#define POINTS_MIN  60u
/* What lies so near the ground and faces up is ground. */
#define GROUND_M         0.12f
#define GROUND_GAPS      0.3f
#define GROUND_UP        0.6f
#define SLABS            16u /* of a scan */
#define LABELLED_AT_ONCE 8192u
/* What fits no plane at all leaves so much at least. */
#define NO_PLANE_M   0.05f
#define COSINE_LEAST 0.15

struct segmentation {
	double gap_m;
	float ground_m;
	ground *ground;
	voxels *voxels;
	struct segment_things things;
	struct plinths plinths;
	GPtrArray *told; /* uint8_t of each scan, by somebody else; NULL: nobody did */
};

void segmentation_free(segmentation *s)
{
	if (!s)
		return;
	ground_free(s->ground);
	voxels_free(s->voxels);
	segment_things_clear(&s->things);
	plinths_clear(&s->plinths);
	g_clear_pointer(&s->told, g_ptr_array_unref);
	g_free(s);
}

double segmentation_gap_m(const segmentation *s)
{
	return s->gap_m;
}

/* ---- points ---- */

/* Where it is and how the surface lies there. */
static void place_point(const struct segmentation_scan *scan, uint64_t i, struct voxel_point *ret)
{
	double normal[3];
	scan_points_position(&scan->points, i, ret->at_m);
	scan_points_normal(&scan->points, i, normal);
	for (int k = 0; k < 3; k++)
		ret->normal[k] = (float)normal[k];
}

void segmentation_point(
	const struct segmentation_scan *scan, uint32_t number, uint64_t i, struct voxel_point *ret)
{
	const struct scan_points *p = &scan->points;
	double away[3], far = 0, facing = 0;
	*ret = (struct voxel_point){ .scan = number,
		.size_m = scan_points_size_m(p, i),
		.rgb = scan_points_rgb(p, i),
		.intensity = scan_points_intensity(p, i),
		.is_late = p->data->points && p->data->points->record[i].return_number > 1 };
	place_point(scan, i, ret);
	ret->error_m = p->geometry && isfinite(p->geometry->plane_error_m[i])
			       ? p->geometry->plane_error_m[i]
			       : fmaxf(ret->size_m, NO_PLANE_M);
	ret->area_m2 = ret->size_m * ret->size_m;
	for (int k = 0; k < 3; k++) {
		away[k] = scan->station_m[k] - ret->at_m[k];
		far += away[k] * away[k];
	}
	if (!scan->has_station || !(far > 0))
		return;
	for (int k = 0; k < 3; k++) {
		ret->towards[k] = (float)(away[k] / sqrt(far));
		facing += ret->normal[k] * ret->towards[k];
	}
	/* one without a normal may face anywhere */
	bool has_normal = ret->normal[0] != 0 || ret->normal[1] != 0 || ret->normal[2] != 0;
	facing = has_normal ? fmax(facing, COSINE_LEAST) : 1;
	ret->area_m2 = scan_points_solid_angle_sr(p, i) * (float)(far / facing);
}

static bool is_ground(const segmentation *s, const struct voxel_point *p)
{
	return p->normal[2] > GROUND_UP && fabsf(ground_height_m(s->ground, p->at_m)) < s->ground_m;
}

struct passes {
	segmentation *s;
	const struct segmentation_source *source;
	const struct segmentation_options *options;
	GArray *stations; /* of double[3] */
	bool has_labels;
};

static bool go_on(const struct passes *p, double fraction, const char *doing, GError **error)
{
	if (!p->options || !p->options->progress ||
		p->options->progress(fraction, doing, p->options->user_data))
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_CANCELLED, "stopped while %s", doing);
	return false;
}

/* Over all points of all scans. Scans are cut into slabs, which threads share; sums are put together slab by slab, and are the
 * same on any number of threads. */
struct pass {
	const char *doing;
	double from, to;
	void *(*begin)(const segmentation *s);
	void (*add)(const segmentation *s, void *slab, const struct voxel_point *p);
	void (*end)(segmentation *s, void *slab); /* frees it */
};

static void take_slab(const segmentation *s, const struct pass *pass, uint32_t number,
	const struct segmentation_scan *scan, uint64_t k, void *slab)
{
	uint64_t end = scan->points.count * (k + 1) / SLABS;
	for (uint64_t i = scan->points.count * k / SLABS; i < end; i++) {
		struct voxel_point point;
		if (!scan_points_has(&scan->points, i))
			continue;
		segmentation_point(scan, number, i, &point);
		pass->add(s, slab, &point);
	}
}

static bool run_pass(const struct passes *p, const struct pass *pass, GError **error)
{
	for (size_t k = 0; k < p->source->scans; k++) {
		struct segmentation_scan scan = { 0 };
		void *slab[SLABS];
		double share = (double)k / (double)p->source->scans;
		if (!go_on(p, pass->from + (pass->to - pass->from) * share, pass->doing, error) ||
			!p->source->open(p->source->user_data, k, &scan, error))
			return false;
#pragma omp parallel for schedule(dynamic)
		for (uint64_t i = 0; i < SLABS; i++) {
			slab[i] = pass->begin(p->s);
			take_slab(p->s, pass, (uint32_t)k, &scan, i, slab[i]);
		}
		for (uint64_t i = 0; i < SLABS; i++)
			pass->end(p->s, slab[i]);
	}
	return true;
}

static void *begin_ground(const segmentation *s)
{
	return ground_new(2 * s->gap_m);
}

static void add_to_ground(const segmentation *s, void *slab, const struct voxel_point *p)
{
	(void)s;
	ground_add(slab, p);
}

static void end_ground(segmentation *s, void *slab)
{
	ground_merge(s->ground, slab);
	ground_free(slab);
}

static void *begin_voxels(const segmentation *s)
{
	return voxels_new(s->gap_m);
}

static void add_to_voxels(const segmentation *s, void *slab, const struct voxel_point *p)
{
	if (!is_ground(s, p))
		voxels_add(slab, p);
}

static void end_voxels(segmentation *s, void *slab)
{
	voxels_merge(s->voxels, slab);
	voxels_free(slab);
}

static const struct pass ground_pass = { "looking for the ground", 0, 0.3, begin_ground,
	add_to_ground, end_ground };
static const struct pass voxel_pass = { "looking at what stands on it", 0.3, 0.6, begin_voxels,
	add_to_voxels, end_voxels };

/* ---- how far apart points are ---- */

static int by_value(const void *a, const void *b)
{
	float x = *(const float *)a, y = *(const float *)b;
	return (x > y) - (x < y);
}

/* Of a cloud, this many median patches; a grid is dense where it matters. */
static double gap_of(const struct scan_points *p)
{
	g_autoptr(GArray) sizes = g_array_new(FALSE, FALSE, sizeof(float));
	if (p->data->grid)
		return 0;
	uint64_t step = MAX(p->count / 20000, 1);
	for (uint64_t i = 0; i < p->count; i += step) {
		float size = scan_points_size_m(p, i);
		if (size > 0)
			g_array_append_val(sizes, size);
	}
	if (!sizes->len)
		return INFINITY;
	qsort(sizes->data, sizes->len, sizeof(float), by_value);
	return GAP_PATCHES * g_array_index(sizes, float, sizes->len / 2);
}

/* What has to be known before the first pass: the gap, by the finest scan, where scanners stood, and whether there are labels. */
static bool look_at_scans(struct passes *p, GError **error)
{
	bool is_given = p->options && p->options->gap_m > 0;
	double gap = INFINITY;
	for (size_t k = 0; k < p->source->scans; k++) {
		struct segmentation_scan scan = { 0 };
		if (!p->source->open(p->source->user_data, k, &scan, error))
			return false;
		if (!is_given)
			gap = fmin(gap, gap_of(&scan.points));
		if (scan.has_station)
			g_array_append_vals(p->stations, scan.station_m, 1);
		p->has_labels |= scan.label != NULL;
	}
	if (is_given)
		p->s->gap_m = p->options->gap_m;
	else
		p->s->gap_m = isfinite(gap) ? fmax(gap, GAP_LEAST_M) : GAP_LEAST_M;
	return true;
}

/* ---- the whole ---- */

/* Asks somebody else about all scans. */
static bool ask(const struct passes *p, GError **error)
{
	segmentation *s = p->s;
	if (!p->options || !p->options->tell)
		return true;
	s->told = g_ptr_array_new_with_free_func(g_free);
	for (size_t k = 0; k < p->source->scans; k++) {
		struct segmentation_scan scan = { 0 };
		if (!go_on(p, 0.6, "asking the model", error) ||
			!p->source->open(p->source->user_data, k, &scan, error))
			return false;
		g_autofree float *height_m = g_new0(float, scan.points.count + 1);
		uint8_t *label = g_malloc(scan.points.count + 1);
		g_ptr_array_add(s->told, label);
#pragma omp parallel for schedule(dynamic, 8192)
		for (uint64_t i = 0; i < scan.points.count; i++) {
			double at[3];
			if (!scan_points_has(&scan.points, i))
				continue;
			scan_points_position(&scan.points, i, at);
			float height = ground_height_m(s->ground, at);
			height_m[i] = isfinite(height) ? height : 0;
		}
		if (!p->options->tell(p->options->teller, &scan, height_m, label, error))
			return false;
	}
	return true;
}

/* What is told of a point: by somebody else, or by its file. */
static uint8_t label_of(
	const segmentation *s, size_t index, const struct segmentation_scan *scan, uint64_t i)
{
	uint8_t told = s->told ? ((const uint8_t *)s->told->pdata[index])[i] : LABEL_NONE;
	return told < SEGMENT_CLASSES ? told : scan->label ? scan->label[i] : LABEL_NONE;
}

/* What files or a model tell of voxels: the class that most of its points have. */
static bool count_labels(const struct passes *p, uint8_t *class, GError **error)
{
	const voxels *v = p->s->voxels;
	g_autofree uint16_t(*votes)[SEGMENT_CLASSES] = NULL;
	for (size_t k = 0; p->has_labels && k < p->source->scans; k++) {
		struct segmentation_scan scan = { 0 };
		if (!p->source->open(p->source->user_data, k, &scan, error))
			return false;
		bool is_told = scan.label || p->s->told;
		if (is_told && !votes)
			votes = g_malloc0_n(v->count + 1, sizeof *votes);
		for (uint64_t i = 0; is_told && i < scan.points.count; i++) {
			double at[3];
			uint8_t label = label_of(p->s, k, &scan, i);
			if (label >= SEGMENT_CLASSES || !scan_points_has(&scan.points, i))
				continue;
			scan_points_position(&scan.points, i, at);
			uint32_t voxel = voxels_find_point(v, at);
			if (voxel != VOXEL_NONE && votes[voxel][label] < G_MAXUINT16)
				votes[voxel][label]++;
		}
	}
	for (uint32_t i = 0; votes && i < v->count; i++) {
		int best = 0;
		for (int c = 1; c < SEGMENT_CLASSES; c++)
			best = votes[i][c] > votes[i][best] ? c : best;
		if (votes[i][best])
			class[i] = (uint8_t)best;
	}
	return true;
}

static bool find_things(const struct passes *p, segments *into, GError **error)
{
	segmentation *s = p->s;
	voxels_finish(s->voxels);
	voxels_link(s->voxels, GAP_POINTS);
	if (!go_on(p, 0.6, "telling things apart", error))
		return false;
	g_autofree struct voxel_shape *shape = voxel_shapes(s->voxels);
	g_autoptr(smooth_regions) regions = smooth_regions_grow(s->voxels, NULL, NULL);
	g_autofree float *height_m = g_new(float, s->voxels->count + 1);
#pragma omp parallel for schedule(static)
	for (uint32_t i = 0; i < s->voxels->count; i++) {
		double at[3];
		voxel_point_m(s->voxels, i, at);
		float height = ground_height_m(s->ground, at);
		height_m[i] = isfinite(height) ? height : 0;
	}
	g_autofree uint8_t *ground_class =
		water_find(s->ground, (const double(*)[3])p->stations->data, p->stations->len);
	struct classify_input in = { s->voxels, shape, regions, s->ground, height_m, ground_class,
		s->ground_m };
	g_autofree uint8_t *class = classify(&in);
	if (!ask(p, error) || !count_labels(p, class, error))
		return false;
	s->plinths = plinths_find(s->ground, s->voxels, class, ground_class, height_m);
	uint32_t points_min =
		p->options && p->options->points_min ? p->options->points_min : POINTS_MIN;
	return segment_things_find(&s->things, &in, class, points_min, into, error);
}

static bool run(struct passes *p, segments *into, GError **error)
{
	segmentation *s = p->s;
	if (!look_at_scans(p, error))
		return false;
	s->ground_m = fmaxf(GROUND_M, GROUND_GAPS * (float)s->gap_m);
	s->ground = ground_new(2 * s->gap_m);
	s->voxels = voxels_new(s->gap_m);
	if (!run_pass(p, &ground_pass, error))
		return false;
	ground_find(s->ground, (const double(*)[3])p->stations->data, p->stations->len);
	return run_pass(p, &voxel_pass, error) && find_things(p, into, error);
}

segmentation *segmentation_new(const struct segmentation_source *source,
	const struct segmentation_options *options, segments *into, GError **error)
{
	g_autoptr(segmentation) s = g_new0(segmentation, 1);
	g_autoptr(GArray) stations = g_array_new(FALSE, FALSE, 3 * sizeof(double));
	struct passes p = { .s = s, .source = source, .options = options, .stations = stations };
	return run(&p, into, error) ? g_steal_pointer(&s) : NULL;
}

/* ---- leaves ---- */

/* last: the voxel of the point before, becomes that of this one. */
static uint16_t leaf_of(const segmentation *s, size_t index, const struct segmentation_scan *scan,
	uint64_t i, uint32_t *last)
{
	const struct segment_things *t = &s->things;
	struct voxel_point p;
	place_point(scan, i, &p);
	uint8_t label = label_of(s, index, scan, i);
	uint32_t voxel =
		is_ground(s, &p) ? VOXEL_NONE : voxels_find_point_after(s->voxels, p.at_m, *last);
	*last = voxel;
	if (voxel != VOXEL_NONE)
		return segment_things_leaf(t, t->leaf_of_voxel[voxel], label);
	uint32_t surfel = ground_surfel(s->ground, p.at_m);
	if (surfel == VOXEL_NONE)
		return segment_things_leaf(t, t->rest[CLASS_OTHER], label);
	uint32_t foot_of = plinths_at(&s->plinths, surfel, p.at_m[2]);
	return segment_things_leaf(t,
		foot_of != VOXEL_NONE ? t->leaf_of_voxel[foot_of] : t->leaf_of_surfel[surfel],
		label);
}

void segmentation_label(const segmentation *s, size_t index, const struct segmentation_scan *scan,
	uint16_t *ret_leaf)
{
#pragma omp parallel for schedule(dynamic)
	for (uint64_t from = 0; from < scan->points.count; from += LABELLED_AT_ONCE) {
		const uint64_t end = MIN(from + LABELLED_AT_ONCE, scan->points.count);
		uint32_t last = VOXEL_NONE;
		for (uint64_t i = from; i < end; i++)
			ret_leaf[i] = scan_points_has(&scan->points, i)
					      ? leaf_of(s, index, scan, i, &last)
					      : SEGMENT_NONE;
	}
}
