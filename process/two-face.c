#include "process/two-face.h"
#include "process/normal-equations.h"
#include "process/two-face-patch.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

#define DEGREE        (G_PI / 180)
#define STEPS_MAX     14
#define STEPS_ALL_MAX 3
/* Beams that are enough for a first answer. */
#define BEAMS_ENOUGH 600000u
#define EVERY_MAX    5
#define PATCHES_MIN  300
/* Where angles are as good as lengths. */
#define REACH_M 5.0
/* Residuals beyond so many spreads weigh less, and beyond so many not at all. */
#define HUBER 1.5
#define CUT   5.0
/* Even walls are not even to less than that. */
#define FLOOR_M 3e-4

static const struct {
	const char *name, *unit;
	double per_unit;
	double prior;   /* what is thought before anything is seen, 1 sigma */
	double seen_to; /* a larger deviation tells nothing */
	double done;    /* steps below end the iteration */
} unknowns[TWO_FACE_UNKNOWNS] = {
	{ "beam zero", "degrees", 180 / G_PI, 2 * DEGREE, 0.02 * DEGREE, 1e-7 },
	{ "tilt", "degrees", 180 / G_PI, 2 * DEGREE, 0.02 * DEGREE, 1e-7 },
	{ "place across", "mm", 1e3, 0.1, 2e-3, 1e-6 },
	{ "place along", "mm", 1e3, 0.1, 2e-3, 1e-6 },
	{ "range offset", "mm", 1e3, 0.1, 2e-3, 1e-6 },
	{ "delay", "ms", 1e3, 3e-3, 5e-4, 1e-6 },
	{ "slack", "degrees", 180 / G_PI, 0.1 * DEGREE, 0.02 * DEGREE, 1e-7 },
};

const char *two_face_name(enum two_face_unknown unknown)
{
	return unknowns[unknown].name;
}

double two_face_in_unit(enum two_face_unknown unknown, double value)
{
	return value * unknowns[unknown].per_unit;
}

const char *two_face_unit(enum two_face_unknown unknown)
{
	return unknowns[unknown].unit;
}

/* R = Rz Ry Rx. */
void two_face_angles(const double r[3][3], double ret_deg[3])
{
	ret_deg[0] = atan2(r[2][1], r[2][2]) / DEGREE;
	ret_deg[1] = asin(CLAMP(-r[2][0], -1, 1)) / DEGREE;
	ret_deg[2] = atan2(r[1][0], r[0][0]) / DEGREE;
}

/* ---- one residual a patch: front less back, and the way back less the way forth ---- */

struct equation {
	double off_m, variance_m2;
	double by[TWO_FACE_UNKNOWNS];
	bool faces; /* it compares the two */
};

struct solving {
	const struct faces *faces;
	struct two_face_place place; /* where the lidar is thought to sit */
	GArray *equations;           /* of struct equation */
	uint32_t every;              /* beams are looked at */
	bool held[TWO_FACE_UNKNOWNS];
	double before[TWO_FACE_UNKNOWNS];
	double covariance[TWO_FACE_UNKNOWNS * TWO_FACE_UNKNOWNS];
};

/* Two of the patch's groups along their common normal. */
static void add_equation(struct solving *s, const struct face_patch *p, int a, int b, double even_m)
{
	const struct patch_plane *plane = &p->plane;
	struct patch_group ga, gb;
	struct equation e = { .faces = a % 2 != b % 2 };
	if (!patch_group_of(p, a, &ga) || !patch_group_of(p, b, &gb) || ga.rms_m > even_m ||
		gb.rms_m > even_m)
		return;
	double aside2 = 0;
	for (int k = 0; k < 3; k++) {
		double d = ga.mean_m[k] - gb.mean_m[k];
		e.off_m += plane->normal[k] * d;
		aside2 += d * d;
		for (int i = 0; i < TWO_FACE_UNKNOWNS; i++)
			e.by[i] += plane->normal[k] * (ga.by[i][k] - gb.by[i][k]);
	}
	e.variance_m2 = ga.rms_m * ga.rms_m / ga.count + gb.rms_m * gb.rms_m / gb.count +
			FLOOR_M * FLOOR_M +
			fmax(aside2 - e.off_m * e.off_m, 0) * plane->tilt_variance;
	g_array_append_val(s->equations, e);
}

/* Of what is seen several times all is told by comparing each with the first. */
static void add_patch(struct solving *s, const struct face_patch *p, double even_m)
{
	int first = -1;
	for (int g = 0; g < PATCH_GROUPS; g++) {
		if (p->sum[g].n < PATCH_BEAMS_MIN)
			continue;
		if (first >= 0)
			add_equation(s, p, first, g, even_m);
		else
			first = g;
	}
}

static double median(GArray *a)
{
	g_array_sort(a, patch_compare_doubles);
	return a->len ? g_array_index(a, double, a->len / 2) : 0;
}

/* How rough what counts as even may be: by the roughness of most, which is the noise of the ranges. */
static double find_even(const struct face_patches *patches)
{
	g_autoptr(GArray) rms = g_array_new(FALSE, FALSE, sizeof(double));
	for (uint32_t i = 0; i < patches->count; i++) {
		struct patch_group g;
		for (int k = 0; k < PATCH_GROUPS; k++)
			if (patch_group_of(&patches->patch[i], k, &g) && g.rms_m < 0.1)
				g_array_append_val(rms, g.rms_m);
	}
	return CLAMP(1.8 * median(rms), 0.004, 0.05);
}

static void make_equations(struct solving *s)
{
	g_autoptr(face_patches) patches = face_patches_new(s->faces, &s->place, s->every);
	double even_m = find_even(patches);
	g_array_set_size(s->equations, 0);
	for (uint32_t i = 0; i < patches->count; i++)
		add_patch(s, &patches->patch[i], even_m);
}

/* The spread of the residuals in units of their own deviations: by the middle one, which strays do not move. */
static double spread_of(const GArray *equations)
{
	g_autoptr(GArray) off = g_array_new(FALSE, FALSE, sizeof(double));
	for (guint i = 0; i < equations->len; i++) {
		const struct equation *e = &g_array_index(equations, struct equation, i);
		double o = fabs(e->off_m) / sqrt(e->variance_m2);
		g_array_append_val(off, o);
	}
	return fmax(1.4826 * median(off), 1);
}

static double weight_of(const struct equation *e, double spread)
{
	double off = fabs(e->off_m) / sqrt(e->variance_m2) / spread;
	double huber = off > CUT ? 0 : off > HUBER ? HUBER / off : 1;
	return huber / (e->variance_m2 * spread * spread);
}

/* Of unknowns that are held only the information is removed. */
static void hold(const struct solving *s, double information[][TWO_FACE_UNKNOWNS], double *gradient)
{
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++) {
		for (int j = 0; s->held[i] && j < TWO_FACE_UNKNOWNS; j++)
			information[i][j] = information[j][i] = 0;
		if (s->held[i])
			gradient[i] = 0;
		if (s->held[i])
			information[i][i] = 1e30;
	}
}

static void sum_up(const struct solving *s, const double *thought,
	double information[][TWO_FACE_UNKNOWNS], double *gradient)
{
	double spread = spread_of(s->equations);
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++) {
		double prior2 = unknowns[i].prior * unknowns[i].prior;
		information[i][i] += 1 / prior2;
		gradient[i] += (s->before[i] - thought[i]) / prior2;
	}
	for (guint n = 0; n < s->equations->len; n++) {
		const struct equation *e = &g_array_index(s->equations, struct equation, n);
		double weight = weight_of(e, spread);
		for (int i = 0; i < TWO_FACE_UNKNOWNS; i++) {
			gradient[i] -= weight * e->by[i] * e->off_m;
			for (int j = 0; j < TWO_FACE_UNKNOWNS; j++)
				information[i][j] += weight * e->by[i] * e->by[j];
		}
	}
	hold(s, information, gradient);
}

static void values_of(const struct two_face_place *p, double ret[TWO_FACE_UNKNOWNS])
{
	double degrees[3];
	two_face_angles(p->lidar.rotation, degrees);
	ret[TWO_FACE_BEAM_ZERO] = p->lidar.beam_zero_rad;
	ret[TWO_FACE_TILT] = degrees[1] * DEGREE;
	ret[TWO_FACE_X] = p->lidar.translation_m[0];
	ret[TWO_FACE_Y] = p->lidar.translation_m[1];
	ret[TWO_FACE_RANGE] = p->lidar.range_offset_m;
	ret[TWO_FACE_DELAY] = p->delay_s;
	ret[TWO_FACE_SLACK] = p->slack_rad;
}

static void set_values(struct two_face_place *p, const double v[TWO_FACE_UNKNOWNS])
{
	double degrees[3];
	two_face_angles(p->lidar.rotation, degrees);
	degrees[1] = v[TWO_FACE_TILT] / DEGREE;
	calibration_rotation(degrees, p->lidar.rotation);
	p->lidar.beam_zero_rad = v[TWO_FACE_BEAM_ZERO];
	p->lidar.translation_m[0] = v[TWO_FACE_X];
	p->lidar.translation_m[1] = v[TWO_FACE_Y];
	p->lidar.range_offset_m = v[TWO_FACE_RANGE];
	p->delay_s = v[TWO_FACE_DELAY];
	p->slack_rad = v[TWO_FACE_SLACK];
}

/* false: it has come to rest, or cannot be solved. */
static bool step(struct solving *s)
{
	double information[TWO_FACE_UNKNOWNS][TWO_FACE_UNKNOWNS] = { { 0 } },
	       gradient[TWO_FACE_UNKNOWNS] = { 0 }, change[TWO_FACE_UNKNOWNS],
	       value[TWO_FACE_UNKNOWNS];
	bool moved = false;
	make_equations(s);
	values_of(&s->place, value);
	sum_up(s, value, information, gradient);
	if (!normal_equations_solve(
		    &information[0][0], gradient, TWO_FACE_UNKNOWNS, change, s->covariance))
		return false;
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++) {
		moved |= fabs(change[i]) > unknowns[i].done;
		value[i] += change[i];
	}
	set_values(&s->place, value);
	return moved;
}

static double deviation_of(const struct solving *s, int i)
{
	return sqrt(s->covariance[i * TWO_FACE_UNKNOWNS + i]);
}

/* What is not seen goes back to what it was; true when there was such. */
static bool hold_unseen(struct solving *s)
{
	double value[TWO_FACE_UNKNOWNS];
	bool any = false;
	values_of(&s->place, value);
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++)
		if (!s->held[i] && deviation_of(s, i) > unknowns[i].seen_to) {
			s->held[i] = any = true;
			value[i] = s->before[i];
		}
	set_values(&s->place, value);
	return any;
}

/* Root of the mean square of how far the faces are apart, strays left out, and what noise alone would make. */
static double face_error(const struct solving *s, double *ret_noise_m, uint32_t *ret_patches)
{
	double spread = spread_of(s->equations), square = 0, noise = 0;
	uint32_t n = 0;
	for (guint i = 0; i < s->equations->len; i++) {
		const struct equation *e = &g_array_index(s->equations, struct equation, i);
		if (!e->faces || fabs(e->off_m) > CUT * spread * sqrt(e->variance_m2))
			continue;
		square += e->off_m * e->off_m;
		noise += e->variance_m2;
		n++;
	}
	*ret_noise_m = sqrt(noise / MAX(n, 1));
	*ret_patches = n;
	return sqrt(square / MAX(n, 1));
}

/* The direction that is known least, angles counted at REACH_M. */
static void find_weakest(const double *covariance, struct two_face_result *ret)
{
	double scaled[TWO_FACE_MOUNT * TWO_FACE_MOUNT], values[TWO_FACE_MOUNT],
		vectors[TWO_FACE_MOUNT * TWO_FACE_MOUNT];
	for (int i = 0; i < TWO_FACE_MOUNT; i++)
		for (int j = 0; j < TWO_FACE_MOUNT; j++)
			scaled[i * TWO_FACE_MOUNT + j] = covariance[i * TWO_FACE_UNKNOWNS + j] *
							 (i <= TWO_FACE_TILT ? REACH_M : 1) *
							 (j <= TWO_FACE_TILT ? REACH_M : 1);
	normal_equations_eigen(scaled, TWO_FACE_MOUNT, values, vectors);
	ret->weakest_deviation_m = sqrt(values[0]);
	memcpy(ret->weakest, vectors, sizeof ret->weakest);
}

static void come_to_rest(struct solving *s, uint32_t every, int steps_max)
{
	s->every = every;
	for (int i = 0; i < steps_max && step(s); i++)
		;
}

static void note_deviations(const struct solving *s, struct two_face_result *ret)
{
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++)
		if (!s->held[i])
			ret->value[i].deviation = deviation_of(s, i);
}

/* By few beams first, then by all. */
static bool find(struct solving *s, struct two_face_result *ret, GError **error)
{
	come_to_rest(s, CLAMP(s->faces->range_m->len / BEAMS_ENOUGH, 1, EVERY_MAX), STEPS_MAX);
	find_weakest(s->covariance, ret);
	do {
		note_deviations(s, ret);
		hold_unseen(s);
		come_to_rest(s, 1, STEPS_ALL_MAX);
	} while (hold_unseen(s));
	note_deviations(s, ret);
	make_equations(s);
	ret->error_after_m = face_error(s, &ret->noise_error_m, &ret->patches);
	if (ret->patches >= PATCHES_MIN)
		return true;
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_DATA,
		"the two faces of the lidar see only %u even places in common: scan with the "
		"preset calibration, among walls",
		ret->patches);
	return false;
}

bool two_face_solve(const struct faces *f, struct two_face_result *ret, GError **error)
{
	g_autoptr(GArray) equations = g_array_new(FALSE, FALSE, sizeof(struct equation));
	struct solving s = {
		.faces = f, .place.lidar = f->calibration.lidar, .equations = equations
	};
	double value[TWO_FACE_UNKNOWNS], noise;
	uint32_t patches;
	*ret = (struct two_face_result){ 0 };
	values_of(&s.place, s.before);
	if (!find(&s, ret, error))
		return false;
	values_of(&s.place, value);
	ret->lidar = s.place.lidar;
	for (int i = 0; i < TWO_FACE_UNKNOWNS; i++) {
		ret->value[i].before = s.before[i];
		ret->value[i].value = value[i];
		ret->value[i].seen = !s.held[i];
	}
	s.place.lidar = f->calibration.lidar;
	make_equations(&s);
	ret->error_before_m = face_error(&s, &noise, &patches);
	return true;
}
