#include "render/kiosk/align-picks.h"
#include "firmware-io/files.h"
#include <string.h>

align_picks *align_picks_new(void)
{
	align_picks *p = g_new0(align_picks, 1);
	p->pairs = g_array_new(FALSE, TRUE, sizeof(struct align_pick));
	return p;
}

align_picks *align_picks_copy(const align_picks *p)
{
	align_picks *c = align_picks_new();
	g_array_append_vals(c->pairs, p->pairs->data, p->pairs->len);
	return c;
}

void align_picks_free(align_picks *p)
{
	if (!p)
		return;
	g_array_unref(p->pairs);
	g_free(p);
}

static struct align_pick *at(const align_picks *p, guint pair)
{
	return &g_array_index(p->pairs, struct align_pick, pair);
}

bool align_picks_find(const range_grid *g, uint32_t *column, uint32_t *row)
{
	int best = G_MAXINT, bc = 0, br = 0;
	for (int r = -3; r <= 3; r++)
		for (int c = -3; c <= 3; c++) {
			int y = (int)*row + r, x = (int)*column + c, n = (int)g->columns;
			x = g->wraps ? (x + n) % n : x;
			if (y < 0 || y >= (int)g->rows || x < 0 || x >= n ||
				r * r + c * c >= best ||
				!(g->range_m[(size_t)y * g->columns + (size_t)x] > 0))
				continue;
			best = r * r + c * c;
			bc = x;
			br = y;
		}
	if (best == G_MAXINT)
		return false;
	*column = (uint32_t)bc;
	*row = (uint32_t)br;
	return true;
}

guint align_picks_add(align_picks *p, int side, uint32_t column, uint32_t row)
{
	guint pair = 0;
	while (pair < p->pairs->len && at(p, pair)->has[side])
		pair++;
	if (pair == p->pairs->len)
		g_array_set_size(p->pairs, pair + 1);
	at(p, pair)->has[side] = true;
	align_picks_move(p, pair, side, column, row);
	return pair;
}

void align_picks_move(align_picks *p, guint pair, int side, uint32_t column, uint32_t row)
{
	at(p, pair)->column[side] = column;
	at(p, pair)->row[side] = row;
}

void align_picks_remove(align_picks *p, guint pair)
{
	g_array_remove_index(p->pairs, pair);
}

static bool is_whole(const struct align_pick *k)
{
	return k->has[0] && k->has[1];
}

guint align_picks_whole(const align_picks *p)
{
	guint n = 0;
	for (guint i = 0; i < p->pairs->len; i++)
		n += is_whole(at(p, i));
	return n;
}

/* ---- how they agree ---- */

static struct picked_point point_of(const struct align_pick *k, int side)
{
	return (struct picked_point){
		.is_cell = true, .column = k->column[side], .row = k->row[side]
	};
}

static GArray *whole_pairs(const align_picks *p)
{
	GArray *pairs = g_array_new(FALSE, FALSE, sizeof(struct picked_pair));
	for (guint i = 0; i < p->pairs->len; i++) {
		struct picked_pair one = { i + 1, point_of(at(p, i), 0), point_of(at(p, i), 1) };
		if (is_whole(at(p, i)))
			g_array_append_val(pairs, one);
	}
	return pairs;
}

bool align_picks_fit(const align_picks *p, const scan_data *a, const scan_data *b,
	double *ret_residual_m, bool *ret_blunder, GError **error)
{
	g_autoptr(GArray) pairs = whole_pairs(p);
	g_autofree struct pick *pick = g_new0(struct pick, pairs->len + 1);
	struct picks_fit fit;
	for (guint i = 0; i < p->pairs->len; i++) {
		ret_residual_m[i] = -1;
		ret_blunder[i] = false;
	}
	if (!pick_file_resolve("picks", pairs, a, b, pick, error) ||
		!picks_fit(pick, pairs->len, &fit, error))
		return false;
	for (guint i = 0, n = 0; i < p->pairs->len; i++)
		if (is_whole(at(p, i))) {
			ret_residual_m[i] = fit.residual_m[n];
			ret_blunder[i] = fit.blunder[n++];
		}
	picks_fit_clear(&fit);
	return true;
}

/* ---- files ---- */

bool align_picks_save(const align_picks *p, const char *path, GError **error)
{
	g_autoptr(GString) text = g_string_new("# picked on the touch screen\n");
	g_autofree char *folder = g_path_get_dirname(path);
	for (guint i = 0; i < p->pairs->len; i++) {
		const struct align_pick *k = at(p, i);
		if (is_whole(k))
			g_string_append_printf(text, "c:%u,%u  c:%u,%u\n", k->column[0], k->row[0],
				k->column[1], k->row[1]);
	}
	return files_make_folder(folder, error) && files_write(path, text->str, text->len, error);
}

align_picks *align_picks_load(const char *path)
{
	align_picks *p = align_picks_new();
	g_autoptr(GArray) pairs = pick_file_read(path, NULL);
	for (guint i = 0; pairs && i < pairs->len; i++) {
		const struct picked_pair *one = &g_array_index(pairs, struct picked_pair, i);
		struct align_pick k = { { true, true }, { one->a.column, one->b.column },
			{ one->a.row, one->b.row } };
		if (one->a.is_cell && one->b.is_cell)
			g_array_append_val(p->pairs, k);
	}
	return p;
}
