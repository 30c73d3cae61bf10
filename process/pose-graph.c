#include "process/pose-graph.h"
#include "process/pose-graph-private.h"
#include <math.h>
#include <string.h>

#define FLOOR_M   0.001
#define FLOOR_RAD 5e-5
#define GATE_M    0.005
#define GATE_RAD  5e-4
#define STEPS_MAX 50

/* ---- one link ---- */

static void skew(const double v[3], double ret[3][3])
{
	memset(ret, 0, 9 * sizeof(double));
	ret[0][1] = -v[2], ret[0][2] = v[1];
	ret[1][0] = v[2], ret[1][2] = -v[0];
	ret[2][0] = -v[1], ret[2][1] = v[0];
}

static void multiply3(const double a[3][3], const double b[3][3], double ret[3][3])
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret[i][j] = a[i][0] * b[0][j] + a[i][1] * b[1][j] + a[i][2] * b[2][j];
}

/* What a rotation vector changes by when a small turn is put behind the rotation (sign 1) or before it (-1): the inverse of
 * SO(3)'s right and left Jacobian. */
static void vector_by_turn(const double w[3], double sign, double ret[3][3])
{
	double square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2], angle = sqrt(square);
	double k = angle < 1e-4 ? 1.0 / 12 : (1 - angle / 2 / tan(angle / 2)) / square;
	double cross[3][3], twice[3][3];
	skew(w, cross);
	multiply3(cross, cross, twice);
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			ret[i][j] = (i == j) + sign * 0.5 * cross[i][j] + k * twice[i][j];
}

static void set_block(double to[6][6], int row, int col, const double m[3][3], double factor)
{
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			to[row + i][col + j] = factor * m[i][j];
}

/* D = between * link^-1 = [Rd, td]. A motion of a takes D to exp(-wa) (Rd, td - va); one of b puts link * exp * link^-1
 * behind D: the turn Re wb, the move Re vb + te x Re wb. */
static void differentiate(const struct pose_link *l, const struct pose *d, const double w[3],
	double by_a[6][6], double by_b[6][6])
{
	static const double one[3][3] = { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } };
	double left[3][3], right[3][3], cross[3][3], product[3][3], moved[3][3];
	memset(by_a, 0, sizeof(matrix6));
	memset(by_b, 0, sizeof(matrix6));
	vector_by_turn(w, -1, left);
	set_block(by_a, 0, 0, left, -1);
	skew(d->translation_m, cross);
	set_block(by_a, 3, 0, cross, 1);
	set_block(by_a, 3, 3, one, -1);
	vector_by_turn(w, 1, right);
	multiply3(right, l->pose.rotation, product);
	set_block(by_b, 0, 0, product, 1);
	skew(l->pose.translation_m, cross);
	multiply3(cross, l->pose.rotation, moved);
	multiply3(d->rotation, moved, product);
	set_block(by_b, 3, 0, product, 1);
	multiply3(d->rotation, l->pose.rotation, product);
	set_block(by_b, 3, 3, product, 1);
}

void pose_link_residual(const struct pose_link *l, const struct pose *a, const struct pose *b,
	double ret[6], double ret_by_a[6][6], double ret_by_b[6][6])
{
	struct pose between = pose_between(a, b), back = pose_inverse(&l->pose);
	struct pose d = pose_compose(&between, &back);
	pose_difference(&POSE_IDENTITY, &d, ret);
	if (ret_by_a && ret_by_b)
		differentiate(l, &d, ret, ret_by_a, ret_by_b);
}

/* ---- weights ---- */

static bool invert6(const matrix6 m, matrix6 ret)
{
	g_autoptr(cholesky) c = cholesky_new(1, NULL, 0);
	cholesky_add_diagonal(c, 0, m);
	if (!cholesky_factor(c, 0))
		return false;
	cholesky_inverse(c, (block6 *)ret);
	return true;
}

void pose_link_information(
	const struct pose_link *l, double floor_m, double floor_rad, double ret[6][6])
{
	matrix6 m;
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			m[i][j] = (l->covariance[i][j] + l->covariance[j][i]) / 2;
	for (int i = 0; i < 6; i++)
		m[i][i] = fmax(m[i][i], 0) + pow(i < 3 ? floor_rad : floor_m, 2);
	if (invert6(m, ret))
		return;
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			ret[i][j] = i == j ? 1 / m[i][i] : 0;
}

static double weigh(const matrix6 information, const double r[6])
{
	double sum = 0;
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			sum += r[i] * information[i][j] * r[j];
	return sum;
}

double pose_link_error(const struct pose_link *l, const matrix6 information, const struct pose *a,
	const struct pose *b)
{
	double r[6];
	pose_link_residual(l, a, b, r, NULL, NULL);
	return weigh(information, r);
}

/* ---- the least squares ---- */

struct problem {
	struct pose_node *node;
	const struct pose_link *link;
	const matrix6 *information;
	const double *weight;
	size_t nodes, links;
	uint32_t *index; /* of a node among the free ones; UINT32_MAX: held */
	size_t free;
	cholesky *c;
	double *gradient;
};

static void number_nodes(struct problem *p, const bool *held)
{
	p->index = g_new(uint32_t, p->nodes);
	for (size_t i = 0; i < p->nodes; i++)
		p->index[i] = held[i] ? UINT32_MAX : (uint32_t)p->free++;
}

static bool both_free(const struct problem *p, const struct pose_link *l)
{
	return p->index[l->a] != UINT32_MAX && p->index[l->b] != UINT32_MAX;
}

static void make_pattern(struct problem *p)
{
	g_autofree uint32_t(*pair)[2] = g_malloc_n(p->links + 1, sizeof *pair);
	size_t pairs = 0;
	for (size_t i = 0; i < p->links; i++) {
		if (!(p->weight[i] > 0) || !both_free(p, &p->link[i]))
			continue;
		pair[pairs][0] = p->index[p->link[i].a];
		pair[pairs++][1] = p->index[p->link[i].b];
	}
	p->c = cholesky_new(p->free, (const uint32_t(*)[2])pair, pairs);
	p->gradient = g_new(double, 6 * p->free + 1);
}

/* ret = by^T * information * weight. */
static void weighted_transpose(
	const matrix6 by, const matrix6 information, double weight, matrix6 ret)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++) {
			double sum = 0;
			for (int k = 0; k < 6; k++)
				sum += by[k][i] * information[k][j];
			ret[i][j] = weight * sum;
		}
}

static void multiply6(const matrix6 a, const matrix6 b, matrix6 ret)
{
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++) {
			double sum = 0;
			for (int k = 0; k < 6; k++)
				sum += a[i][k] * b[k][j];
			ret[i][j] = sum;
		}
}

static void add_node(struct problem *p, uint32_t node, const matrix6 weighted, const matrix6 by,
	const double r[6])
{
	matrix6 square;
	uint32_t at = p->index[node];
	if (at == UINT32_MAX)
		return;
	multiply6(weighted, by, square);
	cholesky_add_diagonal(p->c, at, square);
	for (int i = 0; i < 6; i++)
		for (int j = 0; j < 6; j++)
			p->gradient[6 * (size_t)at + i] -= weighted[i][j] * r[j];
}

static void add_link(struct problem *p, size_t i)
{
	const struct pose_link *l = &p->link[i];
	double r[6];
	matrix6 by_a, by_b, weighted_a, weighted_b, product;
	pose_link_residual(l, &p->node[l->a].pose, &p->node[l->b].pose, r, by_a, by_b);
	weighted_transpose(by_a, p->information[i], p->weight[i], weighted_a);
	weighted_transpose(by_b, p->information[i], p->weight[i], weighted_b);
	add_node(p, l->a, weighted_a, by_a, r);
	add_node(p, l->b, weighted_b, by_b, r);
	if (!both_free(p, l))
		return;
	multiply6(weighted_a, by_b, product);
	cholesky_add(p->c, p->index[l->a], p->index[l->b], product);
}

static void add_links(struct problem *p)
{
	cholesky_clear(p->c);
	memset(p->gradient, 0, 6 * p->free * sizeof(double));
	for (size_t i = 0; i < p->links; i++)
		if (p->weight[i] > 0)
			add_link(p, i);
}

static double total_error(const struct problem *p)
{
	double sum = 0;
	for (size_t i = 0; i < p->links; i++) {
		const struct pose_link *l = &p->link[i];
		if (p->weight[i] > 0)
			sum += p->weight[i] * pose_link_error(l, p->information[i],
						      &p->node[l->a].pose, &p->node[l->b].pose);
	}
	return sum;
}

static void move_node(struct pose *pose, const double step[6])
{
	struct pose by = pose_perturb(&POSE_IDENTITY, step);
	*pose = pose_compose(pose, &by);
	pose_orthonormalise(pose);
}

/* Poses moved by the solution of the damped equations; the ones before go to ret_before. Returns the largest step. */
static double take_step(struct problem *p, double damping, struct pose *ret_before)
{
	g_autofree double *step = g_memdup2(p->gradient, 6 * p->free * sizeof(double));
	double largest = 0;
	if (!cholesky_factor(p->c, damping))
		return INFINITY;
	cholesky_solve(p->c, step);
	for (size_t i = 0; i < p->nodes; i++) {
		ret_before[i] = p->node[i].pose;
		if (p->index[i] == UINT32_MAX)
			continue;
		const double *own = step + 6 * (size_t)p->index[i];
		move_node(&p->node[i].pose, own);
		for (int j = 0; j < 6; j++)
			largest = fmax(largest, fabs(own[j]));
	}
	return largest;
}

static void restore(struct problem *p, const struct pose *before)
{
	for (size_t i = 0; i < p->nodes; i++)
		p->node[i].pose = before[i];
}

/* Gauss-Newton; damped more after a step that made things worse (Levenberg 1944, Marquardt 1963). */
static void iterate(struct problem *p, int steps_max)
{
	g_autofree struct pose *before = g_new(struct pose, p->nodes);
	double damping = 1e-9, error = total_error(p);
	bool fresh = false;
	for (int pass = 0; pass < steps_max && damping < 1e6; pass++) {
		if (!fresh)
			add_links(p);
		fresh = true;
		double largest = take_step(p, damping, before);
		if (!isfinite(largest)) {
			damping = fmax(damping, 1e-9) * 100;
			continue;
		}
		double now = total_error(p);
		if (now > error * (1 + 1e-12) + 1e-15) {
			restore(p, before);
			damping = fmax(damping * 10, 1e-4);
			if (largest < 1e-9)
				return;
			continue;
		}
		bool still = largest < 1e-11 || (error - now <= 1e-12 * error && largest < 1e-8);
		error = now;
		damping = damping > 1e-9 ? damping / 10 : damping;
		fresh = false;
		if (still)
			return;
	}
}

static void problem_clear(struct problem *p)
{
	cholesky_free(p->c);
	g_free(p->gradient);
	g_free(p->index);
}

void pose_graph_minimise(struct pose_node *node, size_t nodes, const struct pose_link *link,
	size_t links, const matrix6 *information, const double *weight, const bool *held,
	int steps_max)
{
	struct problem p = { node, link, information, weight, nodes, links };
	number_nodes(&p, held);
	make_pattern(&p);
	if (p.free)
		iterate(&p, steps_max);
	problem_clear(&p);
}

/* ---- the whole ---- */

/* Of the sum of squared errors per redundant equation: covariances may tell less than there is, and never too little. */
static double variance_factor(const struct problem *p)
{
	size_t used = 0;
	for (size_t i = 0; i < p->links; i++)
		used += p->weight[i] > 0;
	double redundant = 6.0 * (double)used - 6.0 * (double)p->free;
	return redundant > 0 ? fmax(1, total_error(p) / redundant) : 1;
}

static void set_covariances(struct problem *p, const bool *held)
{
	g_autofree block6 *inverse = NULL;
	number_nodes(p, held);
	make_pattern(p);
	add_links(p);
	inverse = g_new0(block6, p->free + 1);
	if (p->free && cholesky_factor(p->c, 0))
		cholesky_inverse(p->c, inverse);
	double factor = variance_factor(p);
	for (size_t i = 0; i < p->nodes; i++)
		for (int j = 0; j < 36; j++)
			(&p->node[i].covariance[0][0])[j] =
				held[i] ? 0 : factor * (&inverse[p->index[i]][0][0])[j];
	problem_clear(p);
}

static void set_errors(const struct pose_node *node, struct pose_link *link, size_t links,
	const uint32_t *component)
{
	for (size_t i = 0; i < links; i++) {
		struct pose_link *l = &link[i];
		double r[6] = { 0 };
		if (component[l->a] == component[l->b])
			pose_link_residual(l, &node[l->a].pose, &node[l->b].pose, r, NULL, NULL);
		l->loop_rad = sqrt(r[0] * r[0] + r[1] * r[1] + r[2] * r[2]);
		l->loop_m = sqrt(r[3] * r[3] + r[4] * r[4] + r[5] * r[5]);
	}
}

static matrix6 *informations(
	const struct pose_link *link, size_t links, double floor_m, double floor_rad)
{
	matrix6 *m = g_new(matrix6, links + 1);
	for (size_t i = 0; i < links; i++)
		pose_link_information(&link[i], floor_m, floor_rad, m[i]);
	return m;
}

void pose_graph_hold(const struct pose_node *node, size_t nodes, const uint32_t *component,
	const uint32_t *first, bool *ret_held)
{
	for (size_t i = 0; i < nodes; i++)
		ret_held[i] = node[i].fixed || first[component[i]] == i;
}

/* For covariances the first node that is not fixed is held. One fixed node goes free then: several are not tied to each
 * other by links, so they stay. */
static void hold_first(const struct pose_node *node, size_t nodes, const uint32_t *component,
	uint32_t components, bool *ret_held)
{
	g_autofree bool *seen = g_new0(bool, components + 1);
	g_autofree uint32_t *count = g_new0(uint32_t, components + 1);
	size_t fixed = 0;
	for (size_t i = 0; i < nodes; i++) {
		fixed += node[i].fixed;
		count[component[i]] += !node[i].fixed;
	}
	for (size_t i = 0; i < nodes; i++) {
		bool *had = &seen[component[i]];
		ret_held[i] = node[i].fixed ? fixed > 1 || !count[component[i]] : !*had;
		*had |= !node[i].fixed;
	}
}

/* Components that nothing fixes have their first node at the origin. */
static void move_to_first(struct pose_node *node, size_t nodes, const uint32_t *component,
	const uint32_t *first, uint32_t components)
{
	g_autofree struct pose *back = g_new(struct pose, components + 1);
	for (uint32_t i = 0; i < components; i++) {
		const struct pose_node *head = &node[first[i]];
		back[i] = head->fixed ? POSE_IDENTITY : pose_inverse(&head->pose);
	}
	for (size_t i = 0; i < nodes; i++) {
		if (node[first[component[i]]].fixed)
			continue;
		node[i].pose = first[component[i]] == i
				       ? POSE_IDENTITY
				       : pose_compose(&back[component[i]], &node[i].pose);
		pose_orthonormalise(&node[i].pose);
	}
}

void pose_graph_solve(struct pose_node *node, size_t nodes, struct pose_link *link, size_t links,
	const struct pose_graph_options *options)
{
	struct pose_graph_options o = options ? *options : (struct pose_graph_options){ 0 };
	double floor_m = o.floor_m > 0 ? o.floor_m : FLOOR_M;
	double floor_rad = o.floor_rad > 0 ? o.floor_rad : FLOOR_RAD;
	g_autofree matrix6 *information = informations(link, links, floor_m, floor_rad);
	g_autofree matrix6 *gate = informations(link, links, o.gate_m > 0 ? o.gate_m : GATE_M,
		o.gate_rad > 0 ? o.gate_rad : GATE_RAD);
	g_autofree double *weight = g_new0(double, links + 1);
	g_autofree uint32_t *component = g_new(uint32_t, nodes),
			    *first = g_new(uint32_t, nodes + 1);
	g_autofree bool *held = g_new(bool, nodes);
	pose_graph_reject(node, nodes, link, links, (const matrix6 *)gate, weight);
	uint32_t components =
		pose_graph_components(node, nodes, link, links, weight, component, first);
	move_to_first(node, nodes, component, first, components);
	pose_graph_hold(node, nodes, component, first, held);
	pose_graph_minimise(
		node, nodes, link, links, (const matrix6 *)information, weight, held, STEPS_MAX);
	hold_first(node, nodes, component, components, held);
	struct problem p = { node, link, (const matrix6 *)information, weight, nodes, links };
	set_covariances(&p, held);
	set_errors(node, link, links, component);
	for (size_t i = 0; i < nodes; i++)
		node[i].component = component[i] + 1;
}
