/* The verdict on a pose that was measured. The limits come from simulated courts, streets, bridges and halls, some thousand
 * poses right and wrong. */
#include "process/verify.h"
#include <stdarg.h>

/* Of a pose of a site's own scans, without things that moved, conflicts are below 2 %; with cars, people and furniture
 * elsewhere mostly below 8 %. Scans of different places come to rest with 14 % or more. Where little is shared, moved things
 * must not excuse what a wrong pose does. */
#define CONFLICT_MAX       0.09
#define CONFLICT_FEW_MAX   0.025
#define FEW_SR             1.2
#define CONFLICT_THING_MAX 0.07 /* where things beside a scanner were left out */
#define MISSED_MAX         0.03 /* on top */
#define AGREE_MIN_SR       0.6
#define OVERLAP_MIN        0.15
#define BALANCE_MIN        0.02
/* A rival is refuted by things that it puts where they were seen through, and which this pose explains: by so much more of
 * them, and this on top. Where two poses are truly alike, the worse of them has up to 0.1 %, and up to 1 % where each surface
 * rests on one beam, which may have met an edge; a hall's half turn that its furniture tells apart, 0.25 % and more. But when
 * things moved, the true pose has its percent, and a half turn that shows little of the place has less: some thing that it
 * does not show is held against it. Of 394 pairs in halls, 162 with furniture moved, the half turn came first in 11; the true
 * pose would have had to contradict itself 1.5 times as much to be refuted then. */
#define RIVAL_FACTOR     1.75
#define RIVAL_DOUBT_SR   0.02
#define RIVAL_MARGIN     0.0010
#define RIVAL_MARGIN_ONE 0.010
#define BEAMS_MANY       3
/* Nothing moved, and this pose shows about as much of the place as the rival. */
#define STILL_MAX      0.0015
#define STILL_SHARE    0.5
#define STILL_MARGIN   0.0015
#define STILL_DOUBT_SR 0.005
/* From here on a rival would hardly be accepted itself: less more of it is enough, or what came to rest between two true
 * poses, along a street with cars elsewhere, would speak against the best. */
#define RIVAL_HOPELESS        0.075
#define RIVAL_HOPELESS_FACTOR 1.25
#define RIVALRY_MAX           99
#define RIVAL_MIN_SR          0.3
#define RIVAL_SHARE           0.1
/* Doubt that comes with every pose: who shares little proves little. */
#define DOUBT_SR 0.01
/* Worse than this in its worst direction a pose slides; between, it is right, but not close enough. */
#define SLIDING_M   0.02
#define SLIDING_RAD (0.2 * G_PI / 180)
/* What agrees must be at rest: a wall whose bricks are as deep as the pose is wrong agrees with it all the same, but pulls. */
#define REST_MAX_M    0.010
#define REST_MAX_RAD  (0.05 * G_PI / 180)
#define IMPRECISE_M   1.6e-3
#define IMPRECISE_RAD (0.010 * G_PI / 180)

double verify_contradiction(const struct verification *v)
{
	double sum = v->agree_sr + v->conflict_sr;
	return sum > 0 ? v->conflict_sr / sum : 1;
}

double verify_doubt(const struct verification *v)
{
	double doubt = v->conflict_sr + DOUBT_SR;
	return doubt / (v->agree_sr + doubt);
}

double verify_rivalry(const struct verification *v, const struct verification *rival)
{
	if (rival->agree_sr < fmax(RIVAL_MIN_SR, RIVAL_SHARE * v->agree_sr))
		return 0;
	bool still = v->together_sr < STILL_MAX * v->agree_sr &&
		     v->agree_sr >= STILL_SHARE * rival->agree_sr && v->beams >= BEAMS_MANY;
	double doubt = v->together_sr + (still ? STILL_DOUBT_SR : RIVAL_DOUBT_SR),
	       own = doubt / (v->agree_sr + doubt),
	       margin = still                    ? STILL_MARGIN
			: v->beams >= BEAMS_MANY ? RIVAL_MARGIN
						 : RIVAL_MARGIN_ONE,
	       hopeless = fmax(RIVAL_HOPELESS, RIVAL_HOPELESS_FACTOR * own),
	       may = fmin(RIVAL_FACTOR * own + margin, hopeless),
	       /* What is overlooked here is so there too, and only then: it may be the same. */
		against = rival->together_sr + (v->thing_sr > 0 ? 0 : rival->thing_together_sr),
	       does = against / (rival->agree_sr + against);
	return may < RIVALRY_MAX * does ? may / does : RIVALRY_MAX;
}

static void say(struct verification *v, enum verdict verdict, const char *format, ...)
	G_GNUC_PRINTF(3, 4);
static void say(struct verification *v, enum verdict verdict, const char *format, ...)
{
	va_list args;
	va_start(args, format);
	v->verdict = verdict;
	g_vsnprintf(v->reason, sizeof v->reason, format, args);
	va_end(args);
}

void verify_no_solution(struct verification *ret)
{
	*ret = (struct verification){ 0 };
	say(ret, VERDICT_NO_SOLUTION,
		"No pose was found in which the two scans share enough surface to compare.");
}

bool verify_shares_enough(const struct verification *v)
{
	return v->agree_sr >= AGREE_MIN_SR && v->overlap >= OVERLAP_MIN;
}

static bool shares_enough(struct verification *v)
{
	if (verify_shares_enough(v))
		return true;
	say(v, VERDICT_NO_OVERLAP,
		"In the best pose the scans share only %.2f sr of surface, %.0f %% of what both "
		"look at: too little to tell.",
		v->agree_sr, 100 * v->overlap);
	return false;
}

static bool agrees(struct verification *v)
{
	double conflict = verify_contradiction(v), most = v->agree_sr < FEW_SR ? CONFLICT_FEW_MAX
							  : v->thing_sr > 0    ? CONFLICT_THING_MAX
									       : CONFLICT_MAX;
	if (conflict <= most && 1 - v->agreement <= most + MISSED_MAX)
		return true;
	if (conflict > most)
		say(v, VERDICT_CONFLICT,
			"In the best pose %.1f %% of the surfaces stand where the other scan saw "
			"through (at most %.1f %% may).",
			100 * conflict, 100 * most);
	else
		say(v, VERDICT_CONFLICT,
			"In the best pose %.1f %% of the surfaces miss the other scan's by "
			"centimetres or stand where it saw through (at most %.1f %% may).",
			100 * (1 - v->agreement), 100 * (most + MISSED_MAX));
	return false;
}

static bool is_held(struct verification *v)
{
	if (v->deviation_m <= SLIDING_M && v->deviation_rad <= SLIDING_RAD &&
		v->balance >= BALANCE_MIN)
		return true;
	say(v, VERDICT_SLIDING,
		"What the scans share leaves a direction open: it holds the pose to %.0f mm and "
		"%.2f degrees, and %.1f %% of it face the weakest direction.",
		1000 * v->deviation_m, v->deviation_rad * 180 / G_PI, 100 * v->balance / 3);
	return false;
}

static bool is_alone(struct verification *v, const struct verification *rival)
{
	v->rival_score = rival ? verify_rivalry(v, rival) : 0;
	if (v->rival_score < 1)
		return true;
	say(v, VERDICT_AMBIGUOUS,
		"Another pose fits about as well: %.1f %% of the surfaces contradict it, %.1f %% "
		"this one; too little for things that may have moved.",
		100 * verify_contradiction(rival), 100 * verify_contradiction(v));
	return false;
}

static bool is_at_rest(struct verification *v)
{
	if (v->rest_m <= REST_MAX_M && v->rest_rad <= REST_MAX_RAD)
		return true;
	say(v, VERDICT_IMPRECISE,
		"It fits, but what agrees is not at rest: it would move the scan by another %.0f "
		"mm "
		"and %.2f degrees.",
		1000 * v->rest_m, v->rest_rad * 180 / G_PI);
	return false;
}

static bool is_precise(struct verification *v)
{
	if (v->deviation_m <= IMPRECISE_M && v->deviation_rad <= IMPRECISE_RAD)
		return true;
	say(v, VERDICT_IMPRECISE,
		"It fits, but what the scans share holds it to %.1f mm and %.3f degrees only "
		"(1 sigma).",
		1000 * v->deviation_m, v->deviation_rad * 180 / G_PI);
	return false;
}

/* What was left out is told. */
static void tell_thing(struct verification *v)
{
	if (!(v->thing_sr > 0))
		return;
	g_autofree char *thing =
		g_strdup_printf(" Beside a scanner %.2f sr of things came or went.", v->thing_sr);
	g_strlcat(v->reason, thing, sizeof v->reason);
}

void verify_judge(struct verification *v, const struct verification *rival)
{
	v->rival_score = rival ? verify_rivalry(v, rival) : 0;
	if (shares_enough(v) && agrees(v) && is_alone(v, rival) && is_held(v) && is_at_rest(v) &&
		is_precise(v))
		say(v, VERDICT_ACCEPTED,
			"%.0f %% of what both look at agrees and %.1f %% conflicts; held to %.1f "
			"mm "
			"and %.3f degrees.",
			100 * v->overlap, 100 * (1 - v->agreement), 1000 * v->deviation_m,
			v->deviation_rad * 180 / G_PI);
	tell_thing(v);
}
