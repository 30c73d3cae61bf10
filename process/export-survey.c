#include "process/export-walk.h"
#include "process/spacing.h"
#include <math.h>
#include <string.h>

void export_survey_clear(struct export_survey *s)
{
	g_clear_pointer(&s->kept, g_free);
}

static struct export_survey survey_of_nothing(void)
{
	struct export_survey s = {
		.intensity_least = UINT16_MAX, .row_least = UINT32_MAX, .column_least = UINT32_MAX
	};
	for (int i = 0; i < 3; i++) {
		s.low_m[i] = INFINITY;
		s.high_m[i] = -INFINITY;
		s.rgb_least[i] = UINT8_MAX;
	}
	return s;
}

static void meet_colour(struct export_survey *s, const struct export_point *p)
{
	for (int i = 0; i < 3; i++) {
		s->rgb_least[i] = MIN(s->rgb_least[i], p->rgb[i]);
		s->rgb_most[i] = MAX(s->rgb_most[i], p->rgb[i]);
		s->has_colour |= p->rgb[i] != 0;
	}
}

static void meet(struct export_survey *s, const struct export_point *p)
{
	s->points++;
	for (int i = 0; i < 3; i++) {
		s->low_m[i] = fmin(s->low_m[i], p->at_m[i]);
		s->high_m[i] = fmax(s->high_m[i], p->at_m[i]);
	}
	meet_colour(s, p);
	s->intensity_least = MIN(s->intensity_least, p->intensity);
	s->intensity_most = MAX(s->intensity_most, p->intensity);
	s->has_intensity |= p->intensity != 0;
	s->has_classes |= p->classification != 0;
	s->return_most = MAX(s->return_most, p->return_number);
	s->row_least = MIN(s->row_least, p->row);
	s->row_most = MAX(s->row_most, p->row);
	s->column_least = MIN(s->column_least, p->column);
	s->column_most = MAX(s->column_most, p->column);
}

/* Where a point lies among those of the other stations. */
static void place_of(const struct export_job *j, const struct export_station *s,
	const struct export_point *p, double ret_m[3])
{
	memcpy(ret_m, p->at_m, sizeof p->at_m);
	if (!export_is_merged(j) && s->has_pose)
		pose_apply(&s->pose, ret_m, ret_m);
}

static bool survey_one(
	const struct export_job *j, struct export_station *s, spacing *apart, GError **error)
{
	g_autoptr(export_walk) w = export_walk_open(j, s, EXPORT_WALK_POINTS, error);
	struct export_survey found = survey_of_nothing();
	const struct export_point *p;
	g_autofree uint8_t *kept = apart ? g_malloc0(s->cells / 8 + 1) : NULL;
	for (size_t count = 1; w && count;) {
		if (!export_walk_next(w, &p, &count, error))
			return false;
		for (size_t i = 0; i < count; i++) {
			uint64_t index = export_walk_index(w, i);
			double at_m[3];
			place_of(j, s, &p[i], at_m);
			if (apart && !spacing_take(apart, at_m)) {
				found.left_out++;
				continue;
			}
			if (apart)
				kept[index / 8] |= (uint8_t)(1 << index % 8);
			meet(&found, &p[i]);
		}
	}
	if (!w)
		return false;
	found.kept = g_steal_pointer(&kept);
	s->survey = found;
	return true;
}

/* Poses of raw stations do not tell where they stand to each other. */
static bool is_thinned_alone(const struct export_job *j)
{
	return j->options->raw;
}

bool export_survey_all(struct export_job *j, GError **error)
{
	double spacing_m = j->options->spacing_m;
	g_autoptr(spacing) apart = spacing_m > 0 ? spacing_new(spacing_m) : NULL;
	for (guint i = 0; i < j->stations->len; i++) {
		if (apart && is_thinned_alone(j) && i) {
			spacing_free(apart);
			apart = spacing_new(spacing_m);
		}
		if (!survey_one(j, export_station_at(j, i), apart, error))
			return false;
	}
	return true;
}
