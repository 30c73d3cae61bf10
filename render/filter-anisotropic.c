#include "render/filter-tables.h"
#include <math.h>

/* Where sectors end beside each other, of the polynomials that weigh them (Kyprianidis, Semmo, Kang & Doellner 2010). */
#define ZERO_CROSS 0.58f
/* Places that count less than this part of the most are left out. */
#define LEAST 0.004f

/* Of eight sectors, of a place in the unit circle. */
static void weigh(float x, float y, float radius, float ret[8])
{
	const float zeta = 2 / radius, sine = sinf(ZERO_CROSS),
		    eta = (zeta + cosf(ZERO_CROSS)) / (sine * sine);
	float sum = 0;
	for (int turned = 0; turned < 2; turned++) {
		float by_x = zeta - eta * x * x, by_y = zeta - eta * y * y;
		float z[4] = { fmaxf(y + by_x, 0), fmaxf(-x + by_y, 0), fmaxf(-y + by_x, 0),
			fmaxf(x + by_y, 0) };
		for (int k = 0; k < 4; k++)
			sum += ret[2 * k + turned] = z[k] * z[k];
		float turned_x = (float)G_SQRT2 / 2 * (x - y);
		y = (float)G_SQRT2 / 2 * (x + y);
		x = turned_x;
	}
	float fall = expf(-3.125f * (x * x + y * y)) / fmaxf(sum, 1e-9f);
	for (int k = 0; k < 8; k++)
		ret[k] *= fall;
}

/* Adds the taps of one sector to the list. */
static void list_sector(
	GArray *taps, const float *weights, int reach, uint32_t pitch, uint32_t sector)
{
	int side = 2 * reach + 1;
	float most = 0, sum = 0;
	for (int n = 0; n < side * side; n++)
		most = fmaxf(most, weights[8 * n + (int)sector]);
	for (int n = 0; n < side * side; n++)
		if (weights[8 * n + (int)sector] > LEAST * most)
			sum += weights[8 * n + (int)sector];
	for (int n = 0; n < side * side; n++) {
		float w = weights[8 * n + (int)sector];
		struct anisotropic_tap t = { (n / side - reach) * (int)pitch + n % side - reach,
			w / sum };
		if (w > LEAST * most)
			g_array_append_val(taps, t);
	}
}

static void list_ellipse(struct anisotropic_pass *p, GArray *taps, float radius, uint32_t ellipse)
{
	float turn = (float)(ellipse / ANISOTROPIC_LENGTHS) * (float)G_PI / ANISOTROPIC_WAYS,
	      anisotropy = (float)(ellipse % ANISOTROPIC_LENGTHS) / (ANISOTROPIC_LENGTHS - 1);
	float along = radius * (1 + anisotropy), across = radius / (1 + anisotropy);
	int reach = (int)p->reach, side = 2 * reach + 1;
	float cosine = cosf(turn), sine = sinf(turn);
	g_autofree float *weights = g_new0(float, 8 * (size_t)side * (size_t)side);
	for (int y = -reach; y <= reach; y++)
		for (int x = -reach; x <= reach; x++) {
			float u = ((float)x * cosine + (float)y * sine) / along,
			      v = ((float)y * cosine - (float)x * sine) / across;
			if (u * u + v * v <= 1)
				weigh(u, v, radius, weights + 8 * ((y + reach) * side + x + reach));
		}
	for (uint32_t sector = 0; sector < ANISOTROPIC_SECTORS; sector++) {
		p->first[ellipse * ANISOTROPIC_SECTORS + sector] = taps->len;
		list_sector(taps, weights, reach, p->pitch, sector);
	}
}

GArray *anisotropic_taps(struct anisotropic_pass *p, float radius)
{
	GArray *taps = g_array_new(FALSE, FALSE, sizeof(struct anisotropic_tap));
	for (uint32_t n = 0; n < ANISOTROPIC_WAYS * ANISOTROPIC_LENGTHS; n++)
		list_ellipse(p, taps, radius, n);
	p->first[G_N_ELEMENTS(p->first) - 1] = taps->len;
	p->tap = (struct anisotropic_tap *)(void *)taps->data;
	return taps;
}

uint32_t anisotropic_reach(float radius)
{
	return MIN((uint32_t)ceilf(radius * 2), ANISOTROPIC_REACH_MOST);
}

static void ellipse_rows(const void *data, uint32_t from, uint32_t end)
{
	const struct anisotropic_pass *p = data;
	for (size_t at = (size_t)from * p->flow.width; at < (size_t)end * p->flow.width; at++)
		p->ellipse[at] = (uint16_t)anisotropic_ellipse(&p->flow.at[at], p->stretch);
}

void filter_anisotropic(struct filter_job *j, const struct step *s)
{
	const struct anisotropic_step *k = &s->anisotropic;
	float radius = fmaxf(k->radius_px * j->px, 1);
	int passes = (int)k->passes;
	struct anisotropic_pass p = {
		.image = &j->image, .stretch = k->stretch, .sharpness = k->sharpness
	};
	p.reach = anisotropic_reach(radius);
	p.pitch = j->image.width + 2 * p.reach;
	p.wide = filter_room_part(j->room, 3,
		((size_t)p.pitch * (j->image.height + 2 * p.reach) + 1) * sizeof *p.wide);
	g_autoptr(GArray) taps = anisotropic_taps(&p, radius);
	for (int n = 0; n < passes && !frame_is_stopped(j->f); n++) {
		p.flow = filter_flow_find(j, k->tensor_px);
		p.ellipse = filter_room_part(
			j->room, 4, (size_t)p.flow.width * p.flow.height * sizeof *p.ellipse);
		filter_each_rows(j, ellipse_rows, &p, p.flow.height, 32);
		filter_each_rows(j, LANES_OF(j->lanes, filter_anisotropic_widen), &p,
			j->image.height + 2 * p.reach, 32);
		filter_each_rows(
			j, LANES_OF(j->lanes, filter_anisotropic_rows), &p, j->image.height, 8);
		filter_finish_part(j, k->where, (float)passes, (float)n);
	}
}
