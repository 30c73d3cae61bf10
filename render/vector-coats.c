#include "render/vector-coats.h"
#include <math.h>
#include <string.h>

struct vector_coats {
	uint32_t across, down;
	float cell_px;
	uint16_t *taken; /* a bit for each coat */
};

vector_coats *vector_coats_new(uint32_t width, uint32_t height, float cell_px)
{
	vector_coats *c = g_new0(vector_coats, 1);
	c->cell_px = cell_px;
	c->across = (uint32_t)((float)width / cell_px) + 1;
	c->down = (uint32_t)((float)height / cell_px) + 1;
	c->taken = g_new0(uint16_t, (size_t)c->across * c->down);
	return c;
}

void vector_coats_free(vector_coats *c)
{
	if (!c)
		return;
	g_free(c->taken);
	g_free(c);
}

void vector_coats_clear(vector_coats *c)
{
	memset(c->taken, 0, sizeof *c->taken * c->across * c->down);
}

/* In cells. */
struct place {
	float x, y, cosine, sine, half_length, half_width;
	bool is_round;
	int left, right, top, bottom; /* right and bottom: behind the last */
};

static struct place place_of(
	const vector_coats *c, const struct stroke *s, enum vector_form form, float width_px)
{
	/* Half a cell more: what touches a cell is in it. */
	bool is_round = form == VECTOR_DOTS;
	float half = is_round ? width_px / 2 : s->half_width_px;
	struct place p = { s->x_px / c->cell_px, s->y_px / c->cell_px, s->along[0], s->along[1],
		(is_round ? half : s->half_length_px) / c->cell_px + 0.5f, half / c->cell_px + 0.5f,
		is_round };
	float x = is_round ? p.half_length
			   : fabsf(p.cosine) * p.half_length + fabsf(p.sine) * p.half_width,
	      y = is_round ? p.half_length
			   : fabsf(p.sine) * p.half_length + fabsf(p.cosine) * p.half_width;
	p.left = (int)fmaxf(p.x - x, 0);
	p.top = (int)fmaxf(p.y - y, 0);
	p.right = (int)fminf(p.x + x + 1, (float)c->across);
	p.bottom = (int)fminf(p.y + y + 1, (float)c->down);
	return p;
}

static inline bool is_in(const struct place *p, int column, int row)
{
	float dx = (float)column + 0.5f - p->x, dy = (float)row + 0.5f - p->y;
	if (p->is_round)
		return dx * dx + dy * dy <= p->half_length * p->half_length;
	return fabsf(dx * p->cosine + dy * p->sine) <= p->half_length &&
	       fabsf(dy * p->cosine - dx * p->sine) <= p->half_width;
}

static uint32_t coats_at(const vector_coats *c, const struct place *p)
{
	uint32_t taken = 0;
	for (int row = p->top; row < p->bottom; row++)
		for (int column = p->left; column < p->right; column++)
			if (is_in(p, column, row))
				taken |= c->taken[(size_t)row * c->across + (size_t)column];
	return taken;
}

uint32_t vector_coats_take(
	vector_coats *c, const struct stroke *s, enum vector_form form, float width_px)
{
	struct place p = place_of(c, s, form, width_px);
	uint32_t bare = ~coats_at(c, &p) & ((1u << VECTOR_COATS) - 1);
	uint32_t coat = bare ? (uint32_t)__builtin_ctz(bare) : VECTOR_COATS - 1;
	for (int row = p.top; row < p.bottom; row++)
		for (int column = p.left; column < p.right; column++)
			if (is_in(&p, column, row))
				c->taken[(size_t)row * c->across + (size_t)column] |=
					(uint16_t)(1u << coat);
	return coat;
}
