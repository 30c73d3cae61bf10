/* Corners of checkerboards to a hundredth of a pixel: boards drawn as a sensor sees them, pixels that gather light, against where their corners are. */
#include "acquire/srgb.h"
#include "process/board-corners.h"
#include <math.h>
#include <string.h>

#define WIDTH   240u
#define HEIGHT  200u
#define RAYS    16
#define WHITE   0.8
#define BLACK   0.03
#define COLUMNS 9u
#define ROWS    6u

static const struct board_desc desc = { COLUMNS, ROWS, 0.06 };

/* A board in perspective: x and y in squares, from the first corner, to pixels. */
struct view {
	double m[3][3];
};

/* Squares of so many pixels, turned, slanted, off the pixels' grid by chance. */
static struct view view_of(GRand *chance, double square_px)
{
	double turn = g_rand_double_range(chance, -0.3, 0.3),
	       narrow = g_rand_double_range(chance, 0.65, 1), c = cos(turn) * square_px,
	       s = sin(turn) * square_px;
	struct view v = { { { c * narrow, -s, 0 }, { s * narrow, c, 0 },
		{ g_rand_double_range(chance, -0.01, 0.01),
			g_rand_double_range(chance, -0.01, 0.01), 1 } } };
	double middle[2] = { 0.5 * (COLUMNS - 1), 0.5 * (ROWS - 1) },
	       w = v.m[2][0] * middle[0] + v.m[2][1] * middle[1] + 1;
	for (int k = 0; k < 2; k++) {
		double at = k ? HEIGHT / 2 : WIDTH / 2;
		v.m[k][2] = (at + g_rand_double(chance)) * w - v.m[k][0] * middle[0] -
			    v.m[k][1] * middle[1];
	}
	return v;
}

static void project(const struct view *v, double x, double y, double ret[2])
{
	double w = v->m[2][0] * x + v->m[2][1] * y + 1;
	for (int k = 0; k < 2; k++)
		ret[k] = (v->m[k][0] * x + v->m[k][1] * y + v->m[k][2]) / w;
}

/* By Cramer's rule, where on the board a pixel looks. */
static void look(const struct view *v, double px, double py, double ret[2])
{
	double a = v->m[0][0] - px * v->m[2][0], b = v->m[0][1] - px * v->m[2][1],
	       c = px - v->m[0][2], d = v->m[1][0] - py * v->m[2][0],
	       e = v->m[1][1] - py * v->m[2][1], f = py - v->m[1][2];
	ret[0] = (c * e - b * f) / (a * e - b * d);
	ret[1] = (a * f - c * d) / (a * e - b * d);
}

static double light_of(const double at[2])
{
	bool inside = at[0] > -1 && at[1] > -1 && at[0] < COLUMNS && at[1] < ROWS;
	return inside && ((int)floor(at[0] + 2) + (int)floor(at[1] + 2)) % 2 ? BLACK : WHITE;
}

/* noise: in steps of 255, of the light. */
static uint8_t *draw(const struct view *v, GRand *chance, double noise)
{
	uint8_t *luma = g_malloc(WIDTH * HEIGHT);
	for (uint32_t y = 0; y < HEIGHT; y++)
		for (uint32_t x = 0; x < WIDTH; x++) {
			double sum = 0, at[2];
			for (int i = 0; i < RAYS * RAYS; i++) {
				look(v, x - 0.5 + (i % RAYS + 0.5) / RAYS,
					y - 0.5 + (i / RAYS + 0.5) / RAYS, at);
				sum += light_of(at);
			}
			double light = sum / (RAYS * RAYS) +
				       noise / 255 *
					       (g_rand_double(chance) + g_rand_double(chance) +
						       g_rand_double(chance) - 1.5) *
					       2;
			luma[y * WIDTH + x] =
				(uint8_t)lrint(16 + 219 * srgb_of(CLAMP(light, 0, 1)));
		}
	return luma;
}

static const struct board {
	const char *path;
	double square_px, noise, rms_px;
} boards[] = { { "/board-corners/small", 9, 0, 0.004 }, { "/board-corners/usual", 14, 0, 0.0025 },
	{ "/board-corners/large", 19, 0, 0.0025 },
	{ "/board-corners/small-and-noisy", 9, 2, 0.012 },
	{ "/board-corners/noisy", 14, 2, 0.008 } };

static void test_board(gconstpointer data)
{
	const struct board *b = data;
	g_autoptr(GRand) chance = g_rand_new_with_seed(3);
	double sum = 0, most = 0, from = 0;
	unsigned count = 0;
	for (int round = 0; round < 4; round++) {
		struct view v = view_of(chance, b->square_px);
		g_autofree uint8_t *luma = draw(&v, chance, b->noise);
		double corner[COLUMNS * ROWS][2], truth[COLUMNS * ROWS][2];
		for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
			project(&v, i % COLUMNS, i / COLUMNS, truth[i]);
			for (int k = 0; k < 2; k++)
				corner[i][k] = truth[i][k] + g_rand_double_range(chance, -0.3, 0.3);
			from += pow(corner[i][0] - truth[i][0], 2) +
				pow(corner[i][1] - truth[i][1], 2);
		}
		board_corners_refine(luma, WIDTH, HEIGHT, &desc, corner);
		for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
			double off = hypot(corner[i][0] - truth[i][0], corner[i][1] - truth[i][1]);
			sum += off * off;
			most = MAX(most, off);
			count++;
		}
	}
	g_test_message("squares of %g px: from %.3f px to %.4f, at worst %.4f", b->square_px,
		sqrt(from / count), sqrt(sum / count), most);
	g_assert_cmpfloat(sqrt(sum / count), <, b->rms_px);
	g_assert_cmpfloat(most, <, 5 * b->rms_px);
}

/* Where there is nothing to be fitted, corners stay. */
static void test_nothing(void)
{
	g_autofree uint8_t *flat = g_malloc(WIDTH * HEIGHT);
	double corner[COLUMNS * ROWS][2], before[COLUMNS * ROWS][2];
	memset(flat, 120, WIDTH * HEIGHT);
	for (int round = 0; round < 3; round++) {
		for (uint32_t i = 0; i < COLUMNS * ROWS; i++) {
			before[i][0] =
				round == 1 ? 5 : 20 + (round == 2 ? 3 : 15) * (i % COLUMNS) + 0.3;
			before[i][1] =
				round == 1 ? 5 : 20 + (round == 2 ? 3 : 15) * (i / COLUMNS) + 0.3;
		}
		memcpy(corner, before, sizeof corner);
		board_corners_refine(flat, WIDTH, HEIGHT, &desc, corner);
		g_assert_cmpmem(corner, sizeof corner, before, sizeof before);
	}
}

int main(int argc, char **argv)
{
	g_test_init(&argc, &argv, NULL);
	for (size_t i = 0; i < G_N_ELEMENTS(boards); i++)
		g_test_add_data_func(boards[i].path, &boards[i], test_board);
	g_test_add_func("/board-corners/nothing", test_nothing);
	return g_test_run();
}
