#define LANES_MAY_BE_WIDE
#include "render/stroke-span-lanes.h"
#include "render/stroke-pack-lanes.h"
#include <string.h>

INLINE vi word_of(const struct stroke_packed *s, vi n, enum stroke_word which)
{
	return gather(s->word + which, n * (int32_t)STROKE_WORDS, 4);
}

/* How far up and down from their middles, and a pixel more for soft edges. */
INLINE vf rows_of(const struct stroke_packed *s, vi n)
{
	vi along = word_of(s, n, STROKE_ALONG_BOTH), halves = word_of(s, n, STROKE_HALVES);
	vf rows = magnitude(second_along(along)) * first_length(halves) +
		  magnitude(first_along(along)) * second_length(halves);
	return rows * (1 / STROKE_ALONG) + 1;
}

INLINE vi row_of(vf y)
{
	vf row = most(least(y + STROKE_SPAN_ABOVE, all(STROKE_SPAN_MOST)), all(0));
	return __builtin_convertvector(row, vi);
}

void LANES_NAME(stroke_find_spans)(struct stroke_block *b)
{
	vi lane;
	for (int k = 0; k < LANES; k++)
		lane[k] = k;
	_Static_assert(STROKE_BLOCK % LANES == 0, "lanes behind the last stroke are of the block");
	for (uint32_t n = 0; n < b->count; n += LANES) {
		vi at = lane + (int32_t)n;
		vf middle = (vf)word_of(b->stroke, at, STROKE_Y), rows = rows_of(b->stroke, at);
		vi span = row_of(middle - rows) | (row_of(middle + rows) + 1) << 16;
		memcpy(b->span + n, &span, sizeof span);
	}
}
