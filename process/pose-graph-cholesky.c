#include "process/pose-graph-cholesky.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Column k of the factor, in the order of elimination: its blocks below the diagonal. */
struct column {
	uint32_t *row; /* rising */
	uint32_t count;
	size_t first; /* of its blocks */
};

struct cholesky {
	size_t nodes, blocks;
	uint32_t *place; /* of a node in the order */
	struct column *column;
	block6 *diagonal, *value;     /* of the matrix */
	block6 *l_diagonal, *l_value; /* of its factor, lower */
};

/* ---- the order of elimination, and what fills in ---- */

static int by_value(gconstpointer a, gconstpointer b)
{
	uint32_t x = *(const uint32_t *)a, y = *(const uint32_t *)b;
	return (x > y) - (x < y);
}

static bool holds(const GArray *set, uint32_t value)
{
	return set->len && bsearch(&value, set->data, set->len, sizeof value, by_value) != NULL;
}

static void insert_new(GArray *set, uint32_t value)
{
	if (holds(set, value))
		return;
	guint at = set->len;
	g_array_append_val(set, value);
	uint32_t *v = (uint32_t *)(void *)set->data;
	for (; at > 0 && v[at - 1] > value; at--)
		v[at] = v[at - 1];
	v[at] = value;
}

static void remove_value(GArray *set, uint32_t value)
{
	uint32_t *at =
		set->len ? bsearch(&value, set->data, set->len, sizeof value, by_value) : NULL;
	if (at)
		g_array_remove_index(set, (guint)(at - (uint32_t *)(void *)set->data));
}

static GArray **neighbours_new(size_t nodes, const uint32_t (*pair)[2], size_t pairs)
{
	GArray **set = g_new(GArray *, nodes);
	for (size_t i = 0; i < nodes; i++)
		set[i] = g_array_new(false, false, sizeof(uint32_t));
	for (size_t i = 0; i < pairs; i++) {
		g_assert(pair[i][0] < nodes && pair[i][1] < nodes && pair[i][0] != pair[i][1]);
		insert_new(set[pair[i][0]], pair[i][1]);
		insert_new(set[pair[i][1]], pair[i][0]);
	}
	return set;
}

static uint32_t least_degree(GArray *const *set, const bool *gone, size_t nodes)
{
	uint32_t best = UINT32_MAX;
	for (uint32_t i = 0; i < nodes; i++)
		if (!gone[i] && (best == UINT32_MAX || set[i]->len < set[best]->len))
			best = i;
	return best;
}

/* Takes a node out: its neighbours become neighbours of each other. */
static void eliminate(GArray **set, uint32_t node)
{
	const GArray *around = set[node];
	for (guint i = 0; i < around->len; i++) {
		uint32_t a = g_array_index(around, uint32_t, i);
		remove_value(set[a], node);
		for (guint j = 0; j < around->len; j++)
			if (i != j)
				insert_new(set[a], g_array_index(around, uint32_t, j));
	}
}

static void set_column(cholesky *c, uint32_t k, const GArray *around)
{
	struct column *column = &c->column[k];
	column->count = around->len;
	column->first = c->blocks;
	c->blocks += around->len;
	column->row = g_new(uint32_t, around->len + 1);
	for (guint i = 0; i < around->len; i++)
		column->row[i] = g_array_index(around, uint32_t, i);
}

static void rows_to_places(cholesky *c)
{
	for (size_t k = 0; k < c->nodes; k++) {
		struct column *column = &c->column[k];
		for (uint32_t i = 0; i < column->count; i++)
			column->row[i] = c->place[column->row[i]];
		qsort(column->row, column->count, sizeof(uint32_t), by_value);
	}
}

cholesky *cholesky_new(size_t nodes, const uint32_t (*pair)[2], size_t pairs)
{
	cholesky *c = g_new0(cholesky, 1);
	GArray **set = neighbours_new(nodes, pair, pairs);
	g_autofree bool *gone = g_new0(bool, nodes);
	c->nodes = nodes;
	c->place = g_new(uint32_t, nodes);
	c->column = g_new0(struct column, nodes);
	for (uint32_t k = 0; k < nodes; k++) {
		uint32_t node = least_degree(set, gone, nodes);
		gone[node] = true;
		c->place[node] = k;
		set_column(c, k, set[node]);
		eliminate(set, node);
	}
	rows_to_places(c);
	for (size_t i = 0; i < nodes; i++)
		g_array_unref(set[i]);
	g_free(set);
	c->diagonal = g_new0(block6, nodes + 1);
	c->l_diagonal = g_new0(block6, nodes + 1);
	c->value = g_new0(block6, c->blocks + 1);
	c->l_value = g_new0(block6, c->blocks + 1);
	return c;
}

void cholesky_free(cholesky *c)
{
	if (!c)
		return;
	for (size_t i = 0; i < c->nodes; i++)
		g_free(c->column[i].row);
	g_free(c->column);
	g_free(c->place);
	g_free(c->diagonal);
	g_free(c->value);
	g_free(c->l_diagonal);
	g_free(c->l_value);
	g_free(c);
}

/* ---- values ---- */

/* Where the block of that row stands in column k; it must be there. */
static size_t block_at(const cholesky *c, uint32_t k, uint32_t row)
{
	const struct column *column = &c->column[k];
	const uint32_t *at = bsearch(&row, column->row, column->count, sizeof row, by_value);
	g_assert(at);
	return column->first + (size_t)(at - column->row);
}

void cholesky_clear(cholesky *c)
{
	memset(c->diagonal, 0, c->nodes * sizeof(block6));
	memset(c->value, 0, c->blocks * sizeof(block6));
}

void cholesky_add_diagonal(cholesky *c, uint32_t node, const block6 value)
{
	double(*to)[6] = c->diagonal[c->place[node]];
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			to[i][j] += value[i][j];
}

void cholesky_add(cholesky *c, uint32_t a, uint32_t b, const block6 value)
{
	uint32_t row = c->place[a], col = c->place[b];
	double(*to)[6] = c->value[block_at(c, MIN(row, col), MAX(row, col))];
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			to[i][j] += row > col ? value[i][j] : value[j][i];
}

/* ---- the factor ---- */

/* Lower factor of a block, in place; the upper part becomes zero. */
static bool factor_block(block6 m)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j <= i; j++) {
			double sum = m[i][j];
			for (int k = 0; k < j; k++)
				sum -= m[i][k] * m[j][k];
			if (i == j && !(sum > 0))
				return false;
			m[i][j] = i == j ? sqrt(sum) : sum / m[j][j];
		}
	for (int i = 0; i < 6; i++)
		for (int j = i + 1; j < 6; j++)
			m[i][j] = 0;
	return true;
}

/* m <- m * l^-T. */
static void divide_block(block6 m, const block6 l)
{
	for (int row = 0; row < 6; row++)
		for (int i = 0; i < 6; i++) {
			double sum = m[row][i];
			for (int k = 0; k < i; k++)
				sum -= m[row][k] * l[i][k];
			m[row][i] = sum / l[i][i];
		}
}

/* m -= a * b^T. */
static void take_off(block6 m, const block6 a, const block6 b)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++) {
			double sum = 0;
			for (int k = 0; k < 6; k++)
				sum += a[i][k] * b[j][k];
			m[i][j] -= sum;
		}
}

static bool factor_column(cholesky *c, uint32_t k)
{
	const struct column *column = &c->column[k];
	if (!factor_block(c->l_diagonal[k]))
		return false;
	for (uint32_t i = 0; i < column->count; i++)
		divide_block(c->l_value[column->first + i], c->l_diagonal[k]);
	for (uint32_t j = 0; j < column->count; j++) {
		block6 *lj = &c->l_value[column->first + j];
		take_off(c->l_diagonal[column->row[j]], *lj, *lj);
		for (uint32_t i = j + 1; i < column->count; i++)
			take_off(c->l_value[block_at(c, column->row[j], column->row[i])],
				c->l_value[column->first + i], *lj);
	}
	return true;
}

bool cholesky_factor(cholesky *c, double damping)
{
	memcpy(c->l_diagonal, c->diagonal, c->nodes * sizeof(block6));
	memcpy(c->l_value, c->value, c->blocks * sizeof(block6));
	for (size_t k = 0; k < c->nodes; k++)
		for (int i = 0; i < 6; i++)
			c->l_diagonal[k][i][i] *= 1 + damping;
	for (uint32_t k = 0; k < c->nodes; k++)
		if (!factor_column(c, k))
			return false;
	return true;
}

/* y -= m * x, or with the transposed block. */
static void take_product(double *y, const block6 m, const double *x, bool transposed)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			y[i] -= (transposed ? m[j][i] : m[i][j]) * x[j];
}

static void forward(const cholesky *c, double *y)
{
	for (uint32_t k = 0; k < c->nodes; k++) {
		double *own = y + 6 * (size_t)k;
		for (int i = 0; i < 6; i++) {
			for (int j = 0; j < i; j++)
				own[i] -= c->l_diagonal[k][i][j] * own[j];
			own[i] /= c->l_diagonal[k][i][i];
		}
		const struct column *column = &c->column[k];
		for (uint32_t i = 0; i < column->count; i++)
			take_product(y + 6 * (size_t)column->row[i], c->l_value[column->first + i],
				own, false);
	}
}

static void backward(const cholesky *c, double *y)
{
	for (uint32_t k = (uint32_t)c->nodes; k-- > 0;) {
		double *own = y + 6 * (size_t)k;
		const struct column *column = &c->column[k];
		for (uint32_t i = 0; i < column->count; i++)
			take_product(own, c->l_value[column->first + i],
				y + 6 * (size_t)column->row[i], true);
		for (int i = 5; i >= 0; i--) {
			for (int j = i + 1; j < 6; j++)
				own[i] -= c->l_diagonal[k][j][i] * own[j];
			own[i] /= c->l_diagonal[k][i][i];
		}
	}
}

void cholesky_solve(const cholesky *c, double *x)
{
	g_autofree double *y = g_new(double, 6 * c->nodes);
	for (size_t i = 0; i < c->nodes; i++)
		memcpy(y + 6 * (size_t)c->place[i], x + 6 * i, 6 * sizeof *x);
	forward(c, y);
	backward(c, y);
	for (size_t i = 0; i < c->nodes; i++)
		memcpy(x + 6 * i, y + 6 * (size_t)c->place[i], 6 * sizeof *x);
}

/* ---- the inverse, where the factor has blocks ---- */

/* ret = l^-1. */
static void invert_lower(const block6 l, block6 ret)
{
	for (int j = 0; j < 6; j++)
		for (int i = 0; i < 6; i++) {
			double sum = i == j;
			for (int k = j; k < i; k++)
				sum -= l[i][k] * ret[k][j];
			ret[i][j] = i < j ? 0 : sum / l[i][i];
		}
}

struct inverse {
	const cholesky *c;
	block6 *diagonal, *value; /* as the factor's */
};

/* Block i, j of the inverse; at other places than the factor's it is not known. */
static double inverse_at(const struct inverse *v, uint32_t i, uint32_t j, int row, int col)
{
	if (i == j)
		return v->diagonal[i][row][col];
	const block6 *m = &v->value[block_at(v->c, MIN(i, j), MAX(i, j))];
	return i > j ? (*m)[row][col] : (*m)[col][row];
}

/* With L = unit * D: Z_ik = -sum Z_ij U_jk, Z_kk = D^-1 - sum U_jk^T Z_jk, where U_jk = L_jk L_kk^-1. */
static void invert_column(struct inverse *v, uint32_t k, block6 *unit)
{
	const struct column *column = &v->c->column[k];
	block6 inverse;
	invert_lower(v->c->l_diagonal[k], inverse);
	for (uint32_t j = 0; j < column->count; j++)
		for (int r = 0; r < 6; r++)
			for (int s = 0; s < 6; s++) {
				unit[j][r][s] = 0;
				for (int t = 0; t < 6; t++)
					unit[j][r][s] += v->c->l_value[column->first + j][r][t] *
							 inverse[t][s];
			}
	for (uint32_t i = 0; i < column->count; i++)
		for (int r = 0; r < 6; r++)
			for (int s = 0; s < 6; s++) {
				double sum = 0;
				for (uint32_t j = 0; j < column->count; j++)
					for (int t = 0; t < 6; t++)
						sum += inverse_at(v, column->row[i], column->row[j],
							       r, t) *
						       unit[j][t][s];
				v->value[column->first + i][r][s] = -sum;
			}
	for (int r = 0; r < 6; r++)
		for (int s = 0; s < 6; s++) {
			double sum = 0;
			for (int t = 0; t < 6; t++)
				sum += inverse[t][r] * inverse[t][s];
			for (uint32_t j = 0; j < column->count; j++)
				for (int t = 0; t < 6; t++)
					sum -= unit[j][t][r] * v->value[column->first + j][t][s];
			v->diagonal[k][r][s] = sum;
		}
}

void cholesky_inverse(const cholesky *c, block6 *ret)
{
	struct inverse v = { c, g_new0(block6, c->nodes + 1), g_new0(block6, c->blocks + 1) };
	g_autofree block6 *unit = g_new(block6, c->nodes);
	for (uint32_t k = (uint32_t)c->nodes; k-- > 0;)
		invert_column(&v, k, unit);
	for (size_t i = 0; i < c->nodes; i++)
		memcpy(ret[i], v.diagonal[c->place[i]], sizeof(block6));
	g_free(v.diagonal);
	g_free(v.value);
}
