#include "render/page-scale.h"
#include "render/page-legend.h"
#include <gio/gio.h>
#include <math.h>
#include <string.h>

/* What rounding may do. */
#define NEARLY 1e-9

static bool read_side(const char *text, const char **ret_end, double *ret)
{
	char *end;
	if (!g_ascii_isdigit(*text))
		return false;
	*ret = g_ascii_strtod(text, &end);
	*ret_end = end;
	return *ret > 0 && isfinite(*ret);
}

bool page_scale_parse(const char *text, double *ret)
{
	double paper, world;
	const char *at;
	if (!read_side(text, &at, &paper) || *at != ':' || !read_side(at + 1, &at, &world) || *at)
		return false;
	double scale = world / paper;
	if (!(scale >= PAGE_SCALE_MIN && scale <= PAGE_SCALE_MAX))
		return false;
	*ret = scale;
	return true;
}

char *page_scale_text(double scale)
{
	return scale < 1 ? g_strdup_printf("%.6g:1", 1 / scale) : g_strdup_printf("1:%.7g", scale);
}

/* 1, 2 and 5 times powers of ten, by number. */
static double round_number(int n)
{
	static const double first[] = { 1, 2, 5 };
	int ten = n >= 0 ? n / 3 : -((2 - n) / 3);
	return first[n - 3 * ten] * pow(10, ten);
}

double page_scale_round_length(double metres)
{
	int n = 3 * (int)floor(log10(metres)) - 1;
	while (round_number(n + 1) <= metres * (1 + NEARLY))
		n++;
	return round_number(n);
}

/* ---- fitting ---- */

struct room {
	double size_mm[2];
	double up_mm; /* how far its middle is above that of the page */
};

static struct room room_of(const struct page_size *size, bool has_legend)
{
	double edge = 0, strip = 0;
	if (has_legend)
		page_legend_edges(size->width_mm, size->height_mm, &edge, &strip);
	return (struct room){ { size->width_mm - 2 * edge, size->height_mm - 2 * edge - strip },
		strip / 2 };
}

static double least_scale(const view *v, const struct room *r)
{
	return fmax(v->span_m[0] / r->size_mm[0], v->span_m[1] / r->size_mm[1]) * 1000;
}

double page_scale_fitting(const view *v, const struct page_size *size, bool has_legend)
{
	struct room r = room_of(size, has_legend);
	double least = fmax(least_scale(v, &r) * (1 - NEARLY), PAGE_SCALE_MIN);
	int n = 3 * (int)floor(log10(least)) - 1;
	while (round_number(n) < least)
		n++;
	return round_number(n);
}

static bool refuse(
	const view *v, const struct page_size *size, bool has_legend, double scale, GError **error)
{
	struct room r = room_of(size, has_legend);
	g_autofree char *asked = page_scale_text(scale),
			*fits = page_scale_text(page_scale_fitting(v, size, has_legend));
	g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
		"view '%s' does not fit: its %.4g x %.4g m are %.4g x %.4g mm at %s, and the page "
		"has "
		"room for %.4g x %.4g; %s fits, or a larger --size",
		v->name, v->span_m[0], v->span_m[1], v->span_m[0] / scale * 1000,
		v->span_m[1] / scale * 1000, asked, r.size_mm[0], r.size_mm[1], fits);
	return false;
}

bool page_scale_set(
	view *v, const struct page_size *size, bool has_legend, double scale, GError **error)
{
	struct room r = room_of(size, has_legend);
	if (!view_is_parallel(v)) {
		g_set_error(error, G_IO_ERROR, G_IO_ERROR_INVALID_ARGUMENT,
			"view '%s' has perspective, and so no scale: plan, elevation-north, "
			"section-a "
			"and the like have one",
			v->name);
		return false;
	}
	if (least_scale(v, &r) > scale * (1 + NEARLY))
		return refuse(v, size, has_legend, scale, error);
	/* Pixels are as wide on the page as it is wide; its height may be a part of one more or less. */
	double m_per_px = size->width_mm / size->width / 1000 * scale;
	struct camera c = view_camera(v, 2, 2);
	v->height_m = m_per_px * size->height;
	for (int k = 0; k < 3; k++) {
		double down = r.up_mm / 1000 * scale * c.down[k];
		v->eye_m[k] += down;
		v->target_m[k] += down;
	}
	return true;
}
