#include "acquire/clock.h"
#include <math.h>

#define WINDOW_S 60.0 /* either side */
#define BLOCK_S  10.0 /* one fit serves this long */
/* Below this base the slope of the envelope is noise: the nominal rate is better. */
#define SLOPE_BASE_MIN_S  5.0
#define REFIT_AFTER_PAIRS 32
#define HOST_MAX_S        1e9

/* device_s counts from the first tick seen; lag_s is host minus device, less the first lag: small
 * numbers, so that doubles keep nanoseconds over days. */
struct pair {
	double device_s, lag_s;
};
struct line {
	double at_s, lag_s, slope;
};

struct device_clock {
	struct device_clock_desc desc;
	int64_t wrap; /* 0: never */
	int64_t last_unwrapped, last_arrival_ns;
	bool started, based;
	int64_t base_ticks, base_ns;
	GArray *pairs; /* of struct pair */
	bool exchanged;
	double exchange_at_s, lag_low_s, lag_high_s; /* bounds on the true lag from exchanges */
	struct line fit;
	double fit_block; /* block of BLOCK_S that fit serves */
	guint fit_pairs;  /* pairs there were when it was made */
	bool fit_valid;
};

device_clock *device_clock_new(const struct device_clock_desc *desc)
{
	device_clock *c = g_new0(device_clock, 1);
	g_assert(desc->ticks_hz > 0);
	c->desc = *desc;
	c->wrap = desc->wrap_at          ? (int64_t)desc->wrap_at
		  : desc->wrap_bits < 63 ? INT64_C(1) << desc->wrap_bits
					 : 0;
	c->pairs = g_array_new(FALSE, FALSE, sizeof(struct pair));
	return c;
}

void device_clock_free(device_clock *c)
{
	if (!c)
		return;
	g_array_unref(c->pairs);
	g_free(c);
}

int64_t device_clock_unwrap(device_clock *c, uint64_t ticks, int64_t arrival_ns)
{
	int64_t t = (int64_t)ticks;
	if (c->started && c->wrap) {
		double elapsed =
			(double)(arrival_ns - c->last_arrival_ns) * 1e-9 * c->desc.ticks_hz;
		double expected = (double)c->last_unwrapped + elapsed;
		t += (int64_t)llround((expected - (double)t) / (double)c->wrap) * c->wrap;
	}
	c->started = true;
	c->last_unwrapped = t;
	c->last_arrival_ns = arrival_ns;
	return t;
}

static void set_base(device_clock *c, int64_t unwrapped, int64_t host_ns)
{
	if (c->based)
		return;
	c->based = true;
	c->base_ticks = unwrapped;
	c->base_ns = host_ns;
}

static double device_seconds(const device_clock *c, double unwrapped)
{
	return (unwrapped - (double)c->base_ticks) / c->desc.ticks_hz;
}

static double host_seconds(const device_clock *c, int64_t host_ns)
{
	return (double)(host_ns - c->base_ns) * 1e-9;
}

void device_clock_add_arrival(device_clock *c, int64_t unwrapped, int64_t arrival_ns)
{
	set_base(c, unwrapped, arrival_ns);
	struct pair p = { .device_s = device_seconds(c, (double)unwrapped) };
	p.lag_s = host_seconds(c, arrival_ns) - p.device_s;
	g_array_append_val(c->pairs, p);
}

/* The exchanges of a scan lie within a second, in which no clock drifts by what they can tell. */
void device_clock_add_exchange(
	device_clock *c, int64_t sent_ns, int64_t unwrapped, int64_t received_ns)
{
	set_base(c, unwrapped, sent_ns);
	double device_s = device_seconds(c, (double)unwrapped);
	double tick_s = c->desc.truncates ? 1.0 / c->desc.ticks_hz : 0.0;
	double low = host_seconds(c, sent_ns) - (device_s + tick_s),
	       high = host_seconds(c, received_ns) - device_s;
	/* Bounds that exclude each other come from a clock that was set: the later ones hold. */
	bool fresh = !c->exchanged || low > c->lag_high_s || high < c->lag_low_s;
	c->lag_low_s = fresh ? low : fmax(c->lag_low_s, low);
	c->lag_high_s = fresh ? high : fmin(c->lag_high_s, high);
	c->exchange_at_s = device_s;
	c->exchanged = true;
}

bool device_clock_is_known(const device_clock *c)
{
	return c->based;
}

static double cross(const struct pair *o, const struct pair *a, const struct pair *b)
{
	return (a->device_s - o->device_s) * (b->lag_s - o->lag_s) -
	       (a->lag_s - o->lag_s) * (b->device_s - o->device_s);
}

static int by_device_time(gconstpointer a, gconstpointer b)
{
	double d = ((const struct pair *)a)->device_s - ((const struct pair *)b)->device_s;
	return (d > 0) - (d < 0);
}

/* Lower hull by Andrew's monotone chain; returns its length. points are sorted and overwritten. */
static guint lower_hull(struct pair *points, guint n)
{
	guint m = 0;
	for (guint i = 0; i < n; i++) {
		while (m >= 2 && cross(&points[m - 2], &points[m - 1], &points[i]) <= 0)
			m--;
		points[m++] = points[i];
	}
	return m;
}

/* The hull's edge below the middle of the points has the least sum of distances to them of all
 * lines below them. */
static struct line line_below(const device_clock *c, const struct pair *points, guint n)
{
	double mean = 0;
	g_autofree struct pair *hull = g_memdup2(points, n * sizeof *points);
	for (guint i = 0; i < n; i++)
		mean += points[i].device_s / n;
	guint m = lower_hull(hull, n), edge = 0;
	while (edge + 2 < m && hull[edge + 1].device_s < mean)
		edge++;
	double limit = (c->desc.drift_max_ppm > 0 ? c->desc.drift_max_ppm
						  : DEVICE_CLOCK_DRIFT_MAX_PPM) *
		       1e-6,
	       slope = 0;
	if (m >= 2 && points[n - 1].device_s - points[0].device_s >= SLOPE_BASE_MIN_S)
		slope = (hull[edge + 1].lag_s - hull[edge].lag_s) /
			(hull[edge + 1].device_s - hull[edge].device_s);
	struct line l = { .at_s = mean, .slope = CLAMP(slope, -limit, limit), .lag_s = INFINITY };
	for (guint i = 0; i < m; i++)
		l.lag_s = fmin(l.lag_s, hull[i].lag_s - l.slope * (hull[i].device_s - mean));
	return l;
}

/* Fit of the pairs around the middle of a block. Pairs arrive nearly in order; the sort makes them
 * exactly so. */
static struct line fit_around(const device_clock *c, double middle_s)
{
	g_autoptr(GArray) near = g_array_new(FALSE, FALSE, sizeof(struct pair));
	const struct pair *nearest = NULL;
	for (guint i = 0; i < c->pairs->len; i++) {
		const struct pair *p = &g_array_index(c->pairs, struct pair, i);
		if (fabs(p->device_s - middle_s) <= WINDOW_S)
			g_array_append_vals(near, p, 1);
		if (!nearest || fabs(p->device_s - middle_s) < fabs(nearest->device_s - middle_s))
			nearest = p;
	}
	if (near->len == 0 && nearest)
		g_array_append_vals(near, nearest, 1);
	if (near->len == 0)
		return (struct line){ 0 };
	g_array_sort(near, by_device_time);
	return line_below(c, (const struct pair *)(void *)near->data, near->len);
}

static double line_at(const struct line *l, double device_s)
{
	return l->lag_s + l->slope * (device_s - l->at_s);
}

/* What the envelope has too much: the least delay. */
static double delay_s(device_clock *c)
{
	if (!c->exchanged || c->pairs->len == 0)
		return (double)c->desc.delay_ns * 1e-9;
	struct line start = fit_around(c, c->exchange_at_s);
	return line_at(&start, c->exchange_at_s) - (c->lag_low_s + c->lag_high_s) / 2;
}

static void refit(device_clock *c, double block)
{
	c->fit = fit_around(c, (block + 0.5) * BLOCK_S);
	c->fit.lag_s -= delay_s(c);
	if (c->pairs->len == 0 && c->exchanged)
		c->fit = (struct line){ .lag_s = (c->lag_low_s + c->lag_high_s) / 2 };
	c->fit_block = block;
	c->fit_pairs = c->pairs->len;
	c->fit_valid = true;
}

int64_t device_clock_host_ns(device_clock *c, double unwrapped)
{
	double device_s = device_seconds(c, unwrapped), block = floor(device_s / BLOCK_S);
	/* While it is live the first seconds refit with every few pairs, later ones less and less
	 * often. */
	guint news = c->pairs->len - c->fit_pairs;
	if (!c->fit_valid || block != c->fit_block ||
		news > MAX(REFIT_AFTER_PAIRS, c->fit_pairs / 4))
		refit(c, block);
	double half_tick_s = c->desc.truncates ? 0.5 / c->desc.ticks_hz : 0.0;
	double host_s = device_s + half_tick_s + line_at(&c->fit, device_s);
	/* Ticks of a record that was made up may be any; times must stay fit to be added. */
	return c->base_ns + (int64_t)llround(CLAMP(host_s, -HOST_MAX_S, HOST_MAX_S) * 1e9);
}

double device_clock_drift_ppm(device_clock *c)
{
	if (c->pairs->len < 2)
		return 0;
	g_autofree struct pair *all =
		g_memdup2(c->pairs->data, c->pairs->len * sizeof(struct pair));
	qsort(all, c->pairs->len, sizeof *all, by_device_time);
	struct line l = line_below(c, all, c->pairs->len);
	return -l.slope * 1e6; /* a device that runs fast lags less and less */
}
