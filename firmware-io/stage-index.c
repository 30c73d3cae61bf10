#include "firmware-io/stage-index.h"
#include <math.h>

void stage_index_start(struct stage_index *x, int64_t now_ns)
{
	x->since_ns = now_ns;
}

void stage_index_forget(struct stage_index *x)
{
	x->direction = 0;
}

int64_t stage_index_pass(struct stage_index *x, int64_t now_ns, int direction, int64_t *ret_from_ns)
{
	bool follows = x->direction == direction;
	int64_t before = x->steps;
	*ret_from_ns = x->since_ns;
	x->since_ns = now_ns;
	x->direction = direction;
	if (!follows)
		return 0;
	x->at += direction * x->spacing;
	x->steps = llround(x->at);
	return x->steps > before ? x->steps - before : before - x->steps;
}

int64_t stage_index_step_ns(int64_t from_ns, int64_t now_ns, int64_t k, int64_t n)
{
	return now_ns - llround((double)(now_ns - from_ns) * (double)(n - k) / (double)n);
}
