#include "render/scene-planes.h"
#include "render/light.h"
#include <gio/gio.h>
#include <string.h>

#define TEXELS_MOST (30u << 20) /* of a storage block of 128 MB (gles-scene.h) */

/* ---- smaller textures ---- */

static uint32_t levels_of(const struct plane_region *r, struct scene_plane *ret, uint32_t first)
{
	uint32_t width = r->width, height = r->height;
	ret->region = r;
	for (ret->levels = 0; ret->levels < SCENE_PLANE_LEVELS; ret->levels++) {
		ret->level[ret->levels] = (struct scene_plane_level){ first, width, height };
		first += width * height;
		if (width == 1 && height == 1) {
			ret->levels++;
			break;
		}
		width = (width + 1) / 2;
		height = (height + 1) / 2;
	}
	return first;
}

static void take_texels(const plane_regions *from, const struct scene_plane *p,
	const struct scene_grey *grey, uint8_t (*to)[4])
{
	const uint8_t(*texel)[4] = from->texel + p->region->first_texel;
	size_t count = (size_t)p->region->width * p->region->height;
	int16_t normal[2];
	model_pack_normal(p->region->normal, normal);
	for (size_t n = 0; n < count; n++) {
		if (texel[n][3])
			memcpy(to[n], texel[n], 4);
		else
			scene_grey_colour(grey, (uint16_t)(texel[n][0] | texel[n][1] << 8),
				p->region->leaf, normal, to[n]);
		to[n][3] = 255;
	}
}

/* Means of four, or of fewer at the ends. */
static void halve(const uint8_t (*from)[4], const struct scene_plane_level *of, uint8_t (*to)[4],
	const struct scene_plane_level *half)
{
	const float *linear = light_of_bytes();
	const uint8_t *srgb = light_srgb_bytes();
	for (uint32_t y = 0; y < half->height; y++)
		for (uint32_t x = 0; x < half->width; x++) {
			uint32_t right = MIN(2 * x + 1, of->width - 1),
				 above = MIN(2 * y + 1, of->height - 1);
			const uint8_t *four[] = { from[2 * y * of->width + 2 * x],
				from[2 * y * of->width + right], from[above * of->width + 2 * x],
				from[above * of->width + right] };
			uint8_t *at = to[y * half->width + x];
			for (int k = 0; k < 3; k++) {
				float mean = (linear[four[0][k]] + linear[four[1][k]] +
						     linear[four[2][k]] + linear[four[3][k]]) /
					     4;
				at[k] = srgb[(int)(mean * (LIGHT_STEPS - 1) + 0.5f)];
			}
			at[3] = 255;
		}
}

static void take_plane(struct scene_planes *p, const struct scene_grey *grey, uint32_t n)
{
	const struct scene_plane *plane = &p->plane[n];
	take_texels(p->regions, plane, grey, p->texel + plane->level[0].first);
	for (uint32_t k = 1; k < plane->levels; k++)
		halve((const uint8_t(*)[4])p->texel + plane->level[k - 1].first,
			&plane->level[k - 1], p->texel + plane->level[k].first, &plane->level[k]);
}

/* ---- all ---- */

void scene_planes_free(struct scene_planes *p)
{
	if (!p)
		return;
	plane_regions_free(p->regions);
	g_free(p->plane);
	g_free(p->texel);
	g_free(p);
}

static struct scene_planes *take(plane_regions *regions, const struct scene_grey *grey)
{
	struct scene_planes *p = g_new0(struct scene_planes, 1);
	p->regions = regions;
	p->plane = g_new0(struct scene_plane, regions->count + 1);
	p->count = regions->count;
	for (uint32_t n = 0; n < p->count; n++)
		p->texels = levels_of(&regions->region[n], &p->plane[n], p->texels);
	p->texel = g_malloc(((size_t)p->texels + 1) * sizeof *p->texel);
#pragma omp parallel for schedule(dynamic, 1)
	for (uint32_t n = 0; n < p->count; n++)
		take_plane(p, grey, n);
	return p;
}

bool scene_planes_load(
	const model *m, const struct scene_grey *grey, struct scene_planes **ret, GError **error)
{
	g_autofree char *folder = g_path_get_dirname(product_path(model_file(m)));
	g_autofree char *path = g_build_filename(folder, "planes.regions", NULL);
	g_autoptr(GError) wrong = NULL;
	g_autoptr(plane_regions) r = plane_regions_open(path, &wrong);
	*ret = NULL;
	if (!r && (g_error_matches(wrong, G_IO_ERROR, G_IO_ERROR_NOT_FOUND) ||
			  g_error_matches(wrong, PRODUCT_ERROR, PRODUCT_ERROR_VERSION)))
		return true;
	if (!r) {
		g_propagate_prefixed_error(
			error, g_steal_pointer(&wrong), "'pleinair process' makes it anew: ");
		return false;
	}
	if (plane_regions_are_of(r, m) && r->count && r->texels < TEXELS_MOST / 4 * 3)
		*ret = take(g_steal_pointer(&r), grey);
	return true;
}

void scene_planes_mark(scene *s, struct scene_chunk *c)
{
	c->on_planes = 0;
	if (!s->planes)
		return;
	for (uint32_t i = c->first; i < c->first + c->count; i++)
		if (plane_regions_explain(s->planes->regions, scene_id(s, i))) {
			s->disc[i] |= SCENE_DISC_PLANE;
			c->on_planes++;
		}
}
