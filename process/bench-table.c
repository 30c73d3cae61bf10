#include "process/bench-table.h"
#include "acquire/cli.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define DEGREES (180 / G_PI)
#define MM      1e3

struct bench_table {
	GArray *trials;
};

struct bench_table *bench_table_new(void)
{
	struct bench_table *t = g_new(struct bench_table, 1);
	t->trials = g_array_new(FALSE, FALSE, sizeof(struct trial));
	return t;
}

void bench_table_free(struct bench_table *t)
{
	if (!t)
		return;
	g_array_unref(t->trials);
	g_free(t);
}

void bench_table_add(struct bench_table *t, const GArray *trials)
{
	guint first = t->trials->len;
	g_array_append_vals(t->trials, trials->data, trials->len);
	for (guint i = first; i < t->trials->len; i++) {
		struct trial *one = &g_array_index(t->trials, struct trial, i);
		one->a = one->b = NULL;
		one->site_a = one->site_b = NULL;
	}
}

uint32_t bench_table_count(const struct bench_table *t)
{
	return t->trials->len;
}

/* ---- sums ---- */

struct sums {
	uint32_t trials, outcome[TRIAL_OUTCOMES],
		verdict[VERDICTS]; /* of the true that were not accepted, and the missed */
	uint32_t beyond;           /* accepted, true, but not as close as is asked for */
	GArray *degrees, *mm;      /* of the accepted and true */
	double coarse_s, fine_s, verify_s;
};

static void sums_begin(struct sums *s)
{
	*s = (struct sums){ .degrees = g_array_new(FALSE, FALSE, sizeof(double)),
		.mm = g_array_new(FALSE, FALSE, sizeof(double)) };
}

static void sums_end(struct sums *s)
{
	g_array_unref(s->degrees);
	g_array_unref(s->mm);
}

static void sums_add(struct sums *s, const struct trial *t)
{
	const struct pair_result *r = &t->result;
	s->trials++;
	s->outcome[t->outcome]++;
	s->coarse_s += r->coarse_s;
	s->fine_s += r->fine_s;
	s->verify_s += r->verify_s;
	if (t->outcome == TRIAL_REFUSED || t->outcome == TRIAL_MISSED)
		s->verdict[r->verification.verdict]++;
	if (t->outcome != TRIAL_RIGHT)
		return;
	double degrees = t->error_rad * DEGREES, mm = t->error_m * MM;
	g_array_append_val(s->degrees, degrees);
	g_array_append_val(s->mm, mm);
	s->beyond += t->error_rad > TRIAL_GOOD_RAD || t->error_m > TRIAL_GOOD_M;
}

static int by_value(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double quantile(GArray *values, double share)
{
	if (!values->len)
		return 0;
	g_array_sort(values, by_value);
	return g_array_index(values, double, MIN((guint)(share * values->len), values->len - 1));
}

/* ---- words ---- */

static char *scene_of(const struct trial *t)
{
	return g_strndup(t->name, strcspn(t->name, "-"));
}

static void print_row(const char *name, struct sums *s)
{
	g_autoptr(GString) why = g_string_new(NULL);
	for (int v = 0; v < VERDICTS; v++)
		if (s->verdict[v])
			g_string_append_printf(why, " %s %u", verdict_names[v], s->verdict[v]);
	double n = MAX(s->trials, 1);
	printf("%-22s %6u %5u %8u %5u %8u %6u %5u %7u  %6.4f %6.4f %6.4f  %4.2f %4.2f %5.2f %5u  "
	       "%4.2f "
	       "%4.2f %4.2f %s\n",
		name, s->trials, s->outcome[TRIAL_RIGHT] + s->outcome[TRIAL_REFUSED],
		s->outcome[TRIAL_RIGHT], s->outcome[TRIAL_WRONG], s->outcome[TRIAL_REFUSED],
		s->outcome[TRIAL_MISSED], s->outcome[TRIAL_ALIKE],
		s->outcome[TRIAL_RIGHTLY_REFUSED], quantile(s->degrees, 0.5),
		quantile(s->degrees, 0.95), quantile(s->degrees, 1), quantile(s->mm, 0.5),
		quantile(s->mm, 0.95), quantile(s->mm, 1), s->beyond, s->coarse_s / n,
		s->fine_s / n, s->verify_s / n, why->str);
}

static JsonObject *row_object(const char *scene, const char *kind, struct sums *s)
{
	JsonObject *o = json_object_new(), *why = json_object_new();
	json_object_set_string_member(o, "scene", scene);
	json_object_set_string_member(o, "kind", kind);
	json_object_set_int_member(o, "trials", s->trials);
	json_object_set_int_member(o, "found", s->outcome[TRIAL_RIGHT] + s->outcome[TRIAL_REFUSED]);
	json_object_set_int_member(o, "accepted", s->outcome[TRIAL_RIGHT]);
	json_object_set_int_member(o, "refused_though_true", s->outcome[TRIAL_REFUSED]);
	json_object_set_int_member(o, "accepted_though_wrong", s->outcome[TRIAL_WRONG]);
	json_object_set_int_member(o, "missed", s->outcome[TRIAL_MISSED]);
	json_object_set_int_member(o, "refused_as_alike", s->outcome[TRIAL_ALIKE]);
	json_object_set_int_member(o, "refused_rightly", s->outcome[TRIAL_RIGHTLY_REFUSED]);
	json_object_set_int_member(o, "accepted_beyond_reach", s->beyond);
	for (int v = 0; v < VERDICTS; v++)
		if (s->verdict[v])
			json_object_set_int_member(why, verdict_names[v], s->verdict[v]);
	json_object_set_object_member(o, "refused_or_missed_why", why);
	static const double shares[] = { 0.5, 0.95, 1 };
	static const char *const names[] = { "median", "p95", "worst" };
	for (int i = 0; i < 3; i++) {
		g_autofree char *degrees = g_strdup_printf("error_%s_deg", names[i]);
		g_autofree char *mm = g_strdup_printf("error_%s_mm", names[i]);
		json_object_set_double_member(o, degrees, quantile(s->degrees, shares[i]));
		json_object_set_double_member(o, mm, quantile(s->mm, shares[i]));
	}
	double n = MAX(s->trials, 1);
	json_object_set_double_member(o, "coarse_s", s->coarse_s / n);
	json_object_set_double_member(o, "fine_s", s->fine_s / n);
	json_object_set_double_member(o, "verify_s", s->verify_s / n);
	return o;
}

/* What is printed or put into the array: one scene and kind, or all (NULL, TRIAL_KINDS). */
static void put_row(
	const struct bench_table *t, const char *scene, enum trial_kind kind, JsonArray *to)
{
	struct sums s;
	sums_begin(&s);
	for (guint i = 0; i < t->trials->len; i++) {
		const struct trial *one = &g_array_index(t->trials, struct trial, i);
		g_autofree char *of = scene_of(one);
		if ((!scene || g_str_equal(scene, of)) &&
			(kind == TRIAL_KINDS || one->kind == kind))
			sums_add(&s, one);
	}
	const char *kind_name = kind == TRIAL_KINDS ? "all" : trial_kind_names[kind];
	g_autofree char *name =
		g_strdup_printf("%s%s%s", scene ? scene : "", scene ? ", " : "", kind_name);
	if (s.trials && to)
		json_array_add_object_element(to, row_object(scene ? scene : "all", kind_name, &s));
	else if (s.trials)
		print_row(name, &s);
	sums_end(&s);
}

static void put_rows(const struct bench_table *t, JsonArray *to)
{
	static const char *const scenes[] = { "court", "street", "bridge", "hall" };
	for (int kind = 0; kind < TRIAL_KINDS; kind++) {
		for (gsize i = 0; i < G_N_ELEMENTS(scenes) && kind != TRIAL_NONE; i++)
			put_row(t, scenes[i], (enum trial_kind)kind, to);
		put_row(t, NULL, (enum trial_kind)kind, to);
	}
	put_row(t, NULL, TRIAL_KINDS, to);
}

static void print_times(const struct bench_table *t)
{
	struct sums s;
	sums_begin(&s);
	for (guint i = 0; i < t->trials->len; i++)
		sums_add(&s, &g_array_index(t->trials, struct trial, i));
	double n = MAX(s.trials, 1);
	printf("a pair: %.2f s of one core (reach: <= 1): coarse %.2f, fine %.2f, verify %.2f\n",
		(s.coarse_s + s.fine_s + s.verify_s) / n, s.coarse_s / n, s.fine_s / n,
		s.verify_s / n);
	sums_end(&s);
}

/* Of the pairs that overlap enough: those that can be told, and all. */
struct share {
	double all, found, accepted, with_alike;
};

static struct share share_of(const struct bench_table *t)
{
	uint32_t outcome[TRIAL_OUTCOMES] = { 0 };
	for (guint i = 0; i < t->trials->len; i++) {
		const struct trial *one = &g_array_index(t->trials, struct trial, i);
		if (one->kind == TRIAL_OVERLAP || one->kind == TRIAL_MOVED)
			outcome[one->outcome]++;
	}
	struct share s = { .accepted = outcome[TRIAL_RIGHT] };
	s.found = s.accepted + outcome[TRIAL_REFUSED];
	s.all = s.found + outcome[TRIAL_WRONG] + outcome[TRIAL_MISSED];
	s.with_alike = s.all + outcome[TRIAL_ALIKE];
	return s;
}

static void print_share(const struct bench_table *t)
{
	struct share s = share_of(t);
	printf("of %.0f that overlap: found %.1f %%, refused but true %.1f %%, accepted %.1f %%; "
	       "with the alike, of %.0f: accepted %.1f %%\n",
		s.all, 100 * s.found / MAX(s.all, 1),
		100 * (s.found - s.accepted) / MAX(s.found, 1), 100 * s.accepted / MAX(s.all, 1),
		s.with_alike, 100 * s.accepted / MAX(s.with_alike, 1));
}

uint32_t bench_table_wrong(const struct bench_table *t)
{
	uint32_t wrong = 0;
	for (guint i = 0; i < t->trials->len; i++)
		wrong += g_array_index(t->trials, struct trial, i).outcome == TRIAL_WRONG;
	return wrong;
}

static void print_wrong(const struct bench_table *t)
{
	for (guint i = 0; i < t->trials->len; i++) {
		const struct trial *one = &g_array_index(t->trials, struct trial, i);
		if (one->outcome == TRIAL_WRONG)
			printf("wrong: %s, %.3f degrees and %.1f mm off: %s\n", one->name,
				one->error_rad * DEGREES, one->error_m * MM,
				one->result.verification.reason);
	}
}

void bench_table_print(const struct bench_table *t, JsonArray *others)
{
	if (others) {
		JsonObject *o = json_object_new();
		JsonArray *rows = json_array_new();
		put_rows(t, rows);
		struct share share = share_of(t);
		json_object_set_int_member(o, "trials", bench_table_count(t));
		json_object_set_int_member(o, "overlap", (gint64)share.all);
		if (share.all > 0)
			json_object_set_double_member(
				o, "overlap_found_percent", 100 * share.found / share.all);
		json_object_set_array_member(o, "rows", rows);
		json_object_set_array_member(o, "others", json_array_ref(others));
		cli_print_json(o);
		return;
	}
	printf("%-22s %6s %5s %8s %5s %8s %6s %5s %7s  %-20s  %-15s %5s  %-14s\n", "register",
		"trials", "found", "accepted", "WRONG", "refused", "missed", "alike", "refused",
		"error, degrees", "error, mm", "not", "seconds");
	printf("%-22s %6s %5s %8s %5s %8s %6s %5s %7s  %6s %6s %6s  %4s %4s %5s %5s  %4s %4s %4s\n",
		"", "", "", "", "", "but true", "", "", "rightly", "median", "p95", "worst", "med.",
		"p95", "worst", "close", "crs.", "fine", "ver.");
	put_rows(t, NULL);
	print_times(t);
	printf("reach: found >= 99 %% of overlap and things moved without the alike, refused but "
	       "true < 2 %% of these; wrong 0; error of the accepted <= 0.01 degrees and 2 mm\n"
	       "found: the true pose came first; missed: another, or none, and it was refused\n"
	       "alike: refused as ambiguous in a hall that half a turn does not change, or whose "
	       "furniture all stands elsewhere, or along equal houses\n");
	print_share(t);
	print_wrong(t);
}

/* ---- a line a trial ---- */

static const char *const outcome_names[TRIAL_OUTCOMES] = { "accepted", "WRONG",
	"refused-though-true", "missed", "refused-as-alike", "refused-rightly" };

bool bench_table_save(const struct bench_table *t, const char *path, GError **error)
{
	g_autoptr(GString) text = g_string_new(
		"trial\tkind\toutcome\tverdict\tdistance_m\toverlap\tagreement\tshared_sr\terror_"
		"deg\t"
		"error_mm\tconflict\ttogether_sr\tthing_sr\tagree\tagree_sr\tbalance\tdeviation_"
		"deg\tdeviation_mm\trival\t"
		"rms_mm\tcoarse_s\tfine_s\tverify_s\treason\n");
	for (guint i = 0; i < t->trials->len; i++) {
		const struct trial *one = &g_array_index(t->trials, struct trial, i);
		const struct pair_result *r = &one->result;
		const struct verification *v = &r->verification;
		g_string_append_printf(text,
			"%s\t%s\t%s\t%s\t%.2f\t%.3f\t%.4f\t%.2f\t%.5f\t%.3f\t%.5f\t%.5f\t%.5f\t%."
			"4f\t%."
			"2f\t%"
			".3f\t%.5f\t%.3f\t%.3f\t%.2f\t%.3f\t%.3f\t%.3f\t%s\n",
			one->name, trial_kind_names[one->kind], outcome_names[one->outcome],
			verdict_names[v->verdict], one->distance_m, one->overlap, one->agreement,
			one->shared_sr, one->error_rad * DEGREES, one->error_m * MM,
			verify_contradiction(v), v->together_sr, v->thing_sr, v->agreement,
			v->agree_sr, v->balance, v->deviation_rad * DEGREES, v->deviation_m * MM,
			v->rival_score, v->rms_m * MM, r->coarse_s, r->fine_s, r->verify_s,
			v->reason);
	}
	return g_file_set_contents(path, text->str, (gssize)text->len, error);
}
