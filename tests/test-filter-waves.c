/* Waves in the site, by which a hand is unsteady: where they are, and that they stay there. */
#include "render/filter-tables.h"
#include "tests/filter-reference.h"

#define SHORTEST_PX 60.f

static void waves_on_gles(struct gles_filter_job *j, const void *data)
{
	float *const *to = data;
	gles_waves(j, 2, SHORTEST_PX, gles_calm_depth(j, 3, 4));
	gles_buffer_read(j->d->c, &j->d->filters.plane[2], (int64_t)(WIDTH * HEIGHT * sizeof **to),
		*to, &j->error);
}

/* Of a wall across the view, so far away. */
static float *waves_of_wall(struct filter_made *m, float depth_m)
{
	struct filter_image *i = &m->job.image;
	float *ret = g_new(float, filter_pixels(i));
	m->job.room = &m->room;
	for (size_t at = 0; at < filter_pixels(i); at++)
		i->depth_m[at] = depth_m;
	if (filter_made_gles) {
		g_autoptr(GError) error = NULL;
		gles_filter_picture(filter_made_gles, &m->job, waves_on_gles, &ret, &error);
		g_assert_no_error(error);
	} else {
		const float *here =
			filter_waves(&m->job, 2, SHORTEST_PX, filter_calm_depth(&m->job, 3));
		memcpy(ret, here, filter_pixels(i) * sizeof *ret);
	}
	return ret;
}

static double wave_of(
	const struct camera *c, const struct filter_waves_job *w, int n, const double seen_m[3])
{
	const double *row[3] = { c->right, c->down, c->forward };
	double behind = (double)w->at_eye[n];
	for (int k = 0; k < 3; k++)
		for (int axis = 0; axis < 3; axis++)
			behind += seen_m[k] * row[k][axis] * (double)w->way[n][axis] /
				  (double)w->length_m[n];
	return (double)w->length_m[n] * sin(2 * G_PI * behind);
}

static double octave_at(const struct camera *c, float depth_m)
{
	return log2((double)(SHORTEST_PX * depth_m) / c->focal_px);
}

/* What is longer than the shortest is whole, the shortest one comes, the rest is not there. */
static void test_sum(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	const struct camera *c = &m.frame->camera;
	struct filter_waves_job w;
	double sum2 = 0;
	filter_waves_look(&w, m.frame);
	for (float depth_m = 0.7f; depth_m < 500; depth_m *= 3.1f) {
		g_autofree float *waves = waves_of_wall(&m, depth_m);
		double octave = octave_at(c, depth_m), longest = 0;
		for (uint32_t at = 0; at < WIDTH * HEIGHT; at += 7) {
			double seen_m[3] = { (at % WIDTH + 0.5 - c->width / 2.0) / c->focal_px *
						     (double)depth_m,
				(at / WIDTH + 0.5 - c->height / 2.0) / c->focal_px *
					(double)depth_m,
				(double)depth_m };
			double wanted = 0;
			for (int n = 0; n < FILTER_WAVES; n++) {
				double there = CLAMP(n + FILTER_WAVES_LOWEST + 1 - octave, 0, 1);
				wanted += there * wave_of(c, &w, n, seen_m);
				longest = fmax(longest, there * (double)w.length_m[n]);
			}
			sum2 += wanted * wanted;
			g_assert_cmpfloat(fabs((double)waves[at] - wanted), <, 0.004 * longest);
		}
	}
	g_assert_cmpfloat(sum2, >, 1);
	filter_made_clear(&m);
}

/* A place of the wall, from nearer: but for waves that are no longer than what was the shortest, the same. */
static void test_nearer(gconstpointer on)
{
	if (!goes_on(on))
		return;
	struct filter_made m = filter_made_new(WIDTH, HEIGHT, "");
	g_autoptr(GError) error = NULL;
	struct camera c = m.frame->camera;
	const double far_m = 9, near_m = 6.1;
	double most = 0, moved = 0;
	/* The picture is a part in the middle of what the camera sees. */
	m.job.image.left = (c.width - WIDTH) / 2;
	m.job.image.top = (c.height - HEIGHT) / 2;
	g_autofree float *far_waves = waves_of_wall(&m, (float)far_m);
	for (int k = 0; k < 3; k++)
		c.eye_m[k] += (far_m - near_m) * c.forward[k];
	frame_move(m.frame, &c, &error);
	g_assert_no_error(error);
	g_autofree float *near_waves = waves_of_wall(&m, (float)near_m);
	double shortest_m = exp2(ceil(octave_at(&c, (float)far_m)));
	for (int y = 0; y < (int)HEIGHT; y++)
		for (int x = 0; x < (int)WIDTH; x++) {
			double before[2] = { (x + 0.5 - WIDTH / 2.0) * near_m / far_m +
						     WIDTH / 2.0 - 0.5,
				(y + 0.5 - HEIGHT / 2.0) * near_m / far_m + HEIGHT / 2.0 - 0.5 };
			int at[2] = { (int)before[0], (int)before[1] };
			double u = before[0] - at[0], v = before[1] - at[1], sum = 0;
			for (int n = 0; n < 4; n++)
				sum += (n & 1 ? u : 1 - u) * (n & 2 ? v : 1 - v) *
				       (double)far_waves[(at[1] + (n >> 1)) * (int)WIDTH + at[0] +
							 (n & 1)];
			double here = (double)near_waves[y * (int)WIDTH + x];
			most = fmax(most, fabs(here - sum));
			moved = fmax(moved, fabs(here - (double)far_waves[y * (int)WIDTH + x]));
		}
	g_test_message("places of the wall: %.2f of the shortest wave, of the picture: %.2f",
		most / shortest_m, moved / shortest_m);
	/* A part of it comes, and of what is shorter. */
	g_assert_cmpfloat(most, <, 0.3 * shortest_m);
	g_assert_cmpfloat(moved, >, 1.5 * shortest_m);
	filter_made_clear(&m);
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	add("waves/sum", test_sum);
	add("waves/nearer", test_nearer);
	return run_all();
}
