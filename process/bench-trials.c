#include "process/bench-trials.h"
#include <string.h>

#define NEAR_M 3.0
#define FAR_M  20.0

const char *const trial_kind_names[TRIAL_KINDS] = { "overlap", "things moved", "little overlap",
	"symmetric", "repeated", "no overlap" };

static void add(GArray *list, const struct bench_site *sa, const struct bench_scan *a,
	const struct bench_site *sb, const struct bench_scan *b, enum trial_kind kind)
{
	struct trial t = { .site_a = sa, .site_b = sb, .a = a, .b = b, .kind = kind };
	struct pose truth = pose_between(&a->truth, &b->truth);
	t.distance_m = kind == TRIAL_NONE ? NAN : pose_distance_m(&truth);
	if (kind != TRIAL_NONE && !(t.distance_m >= NEAR_M && t.distance_m <= FAR_M))
		return;
	g_snprintf(t.name, sizeof t.name, "%s%s%s-%" G_GUINT64_FORMAT " %u%s - %s%s%u%s", sa->scene,
		sa->variant ? "-" : "", sa->variant ? sa->variant : "", (guint64)sa->seed,
		a->station, a->moved ? "m" : "", sa == sb ? "" : sb->scene, sa == sb ? "" : " ",
		b->station, b->moved ? "m" : "");
	g_array_append_val(list, t);
}

static void add_pairs_of(GArray *list, const struct bench_site *s)
{
	enum trial_kind plain = !s->variant                            ? TRIAL_OVERLAP
				: g_str_equal(s->variant, "symmetric") ? TRIAL_SYMMETRIC
								       : TRIAL_REPEATED;
	for (uint32_t i = 0; i < s->count; i++)
		for (uint32_t k = i + 1; k < s->count; k++) {
			const struct bench_scan *a = &s->scans[i], *b = &s->scans[k];
			if (a->moved && b->moved)
				continue;
			add(list, s, a, s, b, a->moved == b->moved ? plain : TRIAL_MOVED);
		}
}

static void shuffle(GArray *list, GRand *chance)
{
	for (guint i = list->len; i > 1; i--) {
		guint k = (guint)g_rand_int_range(chance, 0, (gint32)i);
		struct trial swap = g_array_index(list, struct trial, i - 1);
		g_array_index(list, struct trial, i - 1) = g_array_index(list, struct trial, k);
		g_array_index(list, struct trial, k) = swap;
	}
}

static const struct bench_scan *any_scan(const struct bench_site *s, GRand *chance)
{
	return &s->scans[g_rand_int_range(chance, 0, (gint32)s->count)];
}

GArray *trials_list(
	const struct bench_site *sites, uint32_t count, uint32_t max_none, GRand *chance)
{
	GArray *list = g_array_new(FALSE, TRUE, sizeof(struct trial));
	for (uint32_t i = 0; i < count; i++)
		add_pairs_of(list, &sites[i]);
	for (uint32_t i = 0; i < max_none && count > 1; i++) {
		int a = g_rand_int_range(chance, 0, (gint32)count),
		    b = (a + g_rand_int_range(chance, 1, (gint32)count)) % (int)count;
		add(list, &sites[a], any_scan(&sites[a], chance), &sites[b],
			any_scan(&sites[b], chance), TRIAL_NONE);
	}
	shuffle(list, chance);
	return list;
}

/* What the pose must be, and how much the scans share there. */
static struct pose look_at_truth(struct trial *t)
{
	struct fine_result truth = { .pose = pose_between(&t->a->truth, &t->b->truth) };
	struct verification v;
	pair_verify(t->a->scan, t->b->scan, &truth, &v, NULL);
	t->overlap = v.overlap;
	t->agreement = v.agreement;
	t->shared_sr = v.agree_sr;
	bool enough = v.overlap >= TRIAL_OVERLAP_MIN && v.agree_sr >= TRIAL_SHARED_SR;
	if (!enough)
		t->kind = TRIAL_LITTLE;
	return truth.pose;
}

/* The walls of the simulated hall are their own half turn: with all furniture elsewhere nothing tells its ends apart. To
 * refuse such a pair for any other reason is no better than to refuse one that can be told. */
static bool is_alike(const struct trial *t)
{
	return t->kind == TRIAL_SYMMETRIC || t->kind == TRIAL_REPEATED ||
	       (t->kind == TRIAL_MOVED && g_str_equal(t->site_a->scene, "hall"));
}

static enum trial_outcome outcome_of(const struct trial *t)
{
	enum verdict verdict = t->result.verification.verdict;
	bool true_pose = t->kind != TRIAL_NONE && t->error_rad <= TRIAL_WRONG_RAD &&
			 t->error_m <= TRIAL_WRONG_M;
	if (verdict == VERDICT_ACCEPTED)
		return true_pose ? TRIAL_RIGHT : TRIAL_WRONG;
	if (t->kind == TRIAL_NONE || t->kind == TRIAL_LITTLE)
		return TRIAL_RIGHTLY_REFUSED;
	if (is_alike(t) && verdict == VERDICT_AMBIGUOUS)
		return TRIAL_ALIKE;
	return true_pose ? TRIAL_REFUSED : TRIAL_MISSED;
}

void trial_run(struct trial *t)
{
	struct pose truth = POSE_IDENTITY;
	if (t->kind != TRIAL_NONE)
		truth = look_at_truth(t);
	pair_align(t->a->scan, t->b->scan, NULL, &t->result);
	struct pose off = pose_between(&truth, &t->result.pose);
	t->error_rad = pose_angle_rad(&off);
	t->error_m = pose_distance_m(&off);
	t->outcome = outcome_of(t);
}
