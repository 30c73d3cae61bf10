/* Which links disagree with the loops that they close. */
#include "process/pose-graph-private.h"
#include <math.h>
#include <string.h>

#define LIMIT      27.86 /* of chi^2 with 6 degrees of freedom: one in 10,000 right links is beyond */
#define GROWTH     1.4   /* of how far the problem is from convex, as Yang and others have it */
#define ROUNDS_MAX 200
#define STEPS      3

struct rejecting {
	struct pose_node *node;
	struct pose_link *link;
	const matrix6 *gate;
	size_t nodes, links;
	double *weight;
	double *error; /* squared, of each link, in sigmas */
	uint32_t *component, *first;
	bool *held;
};

static void solve(struct rejecting *r, int steps_max)
{
	pose_graph_components(
		r->node, r->nodes, r->link, r->links, r->weight, r->component, r->first);
	pose_graph_hold(r->node, r->nodes, r->component, r->first, r->held);
	pose_graph_minimise(
		r->node, r->nodes, r->link, r->links, r->gate, r->weight, r->held, steps_max);
	for (size_t i = 0; i < r->links; i++)
		r->error[i] = pose_link_error(&r->link[i], r->gate[i], &r->node[r->link[i].a].pose,
			&r->node[r->link[i].b].pose);
}

static double largest_error(const struct rejecting *r)
{
	double largest = 0;
	for (size_t i = 0; i < r->links; i++)
		if (!r->link[i].trusted)
			largest = fmax(largest, r->error[i]);
	return largest;
}

/* Truncated least squares, convex for mu near 0. Returns whether all weights are 0 or 1. */
static bool weigh(struct rejecting *r, double mu)
{
	bool sharp = true;
	for (size_t i = 0; i < r->links; i++) {
		double error = r->error[i];
		if (r->link[i].trusted || error <= mu / (mu + 1) * LIMIT)
			r->weight[i] = 1;
		else if (error >= (mu + 1) / mu * LIMIT)
			r->weight[i] = 0;
		else
			r->weight[i] = fmin(1, fmax(0, sqrt(LIMIT * mu * (mu + 1) / error) - mu));
		sharp = sharp && (r->weight[i] == 0 || r->weight[i] == 1);
	}
	return sharp;
}

static void sharpen(struct rejecting *r)
{
	double largest = largest_error(r);
	if (largest <= LIMIT)
		return;
	double mu = LIMIT / (2 * largest - LIMIT);
	for (int round = 0; round < ROUNDS_MAX; round++) {
		if (weigh(r, mu) && mu > 1)
			return;
		solve(r, STEPS);
		mu *= GROWTH;
	}
}

/* With weights of 0 and 1: links that fit after all come back, the worst that does not goes. */
static bool revise(struct rejecting *r)
{
	bool changed = false;
	size_t worst = r->links;
	for (size_t i = 0; i < r->links; i++) {
		bool fits = r->error[i] <= LIMIT || r->link[i].trusted;
		bool tied = r->component[r->link[i].a] == r->component[r->link[i].b];
		if (r->weight[i] < 1 && (fits || !tied)) {
			r->weight[i] = 1;
			changed = true;
		} else if (r->weight[i] > 0 && !fits &&
			   (worst == r->links || r->error[i] > r->error[worst])) {
			worst = i;
		}
		if (r->weight[i] == 1 && !tied)
			return true;
	}
	if (worst == r->links)
		return changed;
	r->weight[worst] = 0;
	return true;
}

static void round_weights(struct rejecting *r)
{
	for (size_t i = 0; i < r->links; i++)
		r->weight[i] = r->weight[i] >= 0.5 || r->link[i].trusted;
	solve(r, 50);
	for (size_t round = 0; round < 10 + r->links && revise(r); round++)
		solve(r, 50);
}

/* The links on the way between the ends of an outlier that hang by themselves: any of them may be the wrong one instead. */
static void mark_undecided(struct rejecting *r, const bool *bridge, const struct pose_link *outlier)
{
	g_autofree double *without = g_new(double, r->links + 1);
	g_autofree uint32_t *component = g_new(uint32_t, r->nodes),
			    *first = g_new(uint32_t, r->nodes + 1);
	for (size_t i = 0; i < r->links; i++) {
		struct pose_link *l = &r->link[i];
		if (!bridge[i] || l->trusted || l->outlier || r->weight[i] == 0)
			continue;
		memcpy(without, r->weight, r->links * sizeof *without);
		without[i] = 0;
		pose_graph_components(
			r->node, r->nodes, r->link, r->links, without, component, first);
		if (component[outlier->a] != component[outlier->b])
			l->undecided = true;
	}
}

static void mark(struct rejecting *r)
{
	g_autofree bool *bridge = g_new(bool, r->links + 1);
	pose_graph_bridges(r->node, r->nodes, r->link, r->links, r->weight, bridge);
	for (size_t i = 0; i < r->links; i++) {
		r->link[i].outlier = r->weight[i] == 0;
		r->link[i].undecided = false;
	}
	for (size_t i = 0; i < r->links; i++)
		if (r->weight[i] == 0)
			mark_undecided(r, bridge, &r->link[i]);
	for (size_t i = 0; i < r->links; i++)
		if (r->link[i].undecided) {
			r->link[i].outlier = true;
			r->weight[i] = 0;
		}
}

void pose_graph_reject(struct pose_node *node, size_t nodes, struct pose_link *link, size_t links,
	const matrix6 *gate, double *ret_weight)
{
	g_autofree double *error = g_new0(double, links + 1);
	g_autofree uint32_t *component = g_new(uint32_t, nodes),
			    *first = g_new(uint32_t, nodes + 1);
	g_autofree bool *held = g_new(bool, nodes);
	struct rejecting r = { node, link, gate, nodes, links, ret_weight, error, component, first,
		held };
	for (size_t i = 0; i < links; i++)
		ret_weight[i] = 1;
	pose_graph_spread(node, nodes, link, links, gate, LIMIT);
	solve(&r, 50);
	sharpen(&r);
	round_weights(&r);
	mark(&r);
}
