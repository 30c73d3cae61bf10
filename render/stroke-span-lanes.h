#ifndef RENDER_STROKE_SPAN_LANES_H
#define RENDER_STROKE_SPAN_LANES_H
/* Rows that strokes may touch, for all lanes at once. Internal to stroke.c. */
#include "render/stroke.h"

LANES_DECLARE(void, stroke_find_spans, (struct stroke_block * b));

#endif
