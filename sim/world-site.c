#include "sim/world-site.h"

static void free_model(gpointer model)
{
	mesh_clear(model);
	g_free(model);
}

void site_init(struct site *s, uint64_t seed)
{
	*s = (struct site){ .seed = seed, .dice = dice_of(seed, 1) };
	mesh_init(&s->solid);
	mesh_init(&s->glass);
	s->materials = g_array_new(FALSE, FALSE, sizeof(struct material));
	s->clear = g_array_new(FALSE, TRUE, sizeof(uint8_t));
	/* pens hold on to the data, so it must not move when materials are added */
	g_array_set_size(s->clear, G_MAXUINT16 + 1);
	s->objects = g_array_new(FALSE, TRUE, sizeof(uint8_t));
	g_array_set_size(s->objects, 1);
	s->models = g_ptr_array_new_with_free_func(free_model);
	s->placements = g_array_new(FALSE, FALSE, sizeof(struct placement));
	s->walk = g_array_new(FALSE, FALSE, sizeof(vec));
	s->claims = g_array_new(FALSE, FALSE, sizeof(struct disc));
}

void site_clear(struct site *s)
{
	mesh_clear(&s->solid);
	mesh_clear(&s->glass);
	g_clear_pointer(&s->materials, g_array_unref);
	g_clear_pointer(&s->clear, g_array_unref);
	g_clear_pointer(&s->objects, g_array_unref);
	g_clear_pointer(&s->models, g_ptr_array_unref);
	g_clear_pointer(&s->placements, g_array_unref);
	g_clear_pointer(&s->walk, g_array_unref);
	g_clear_pointer(&s->claims, g_array_unref);
}

uint16_t site_material(struct site *s, struct material m)
{
	if (!m.seed)
		m.seed = hash_u32((uint32_t)s->seed + s->materials->len * 7919);
	if (m.reflectivity <= 0)
		m.reflectivity = 0.15f + 0.7f * (m.colour[0] + m.colour[1]) * 0.5f;
	g_array_append_val(s->materials, m);
	g_array_index(s->clear, uint8_t, s->materials->len - 1) =
		material_optics(&m) != WORLD_DIFFUSE;
	return s->materials->len - 1;
}

uint16_t site_object(struct site *s, enum world_class class)
{
	uint8_t byte = class;
	g_array_append_val(s->objects, byte);
	return s->objects->len - 1;
}

struct pen site_pen(struct site *s, float x, float y, float z, float clockwise_rad)
{
	struct pen p = { .mesh = &s->solid,
		.glass = &s->glass,
		.clear = (const uint8_t *)s->clear->data,
		.at = FRAME_WORLD };
	return pen_turned(&p, x, y, z, clockwise_rad);
}

struct pen site_stand(struct site *s, enum world_class class, float x, float y, float clockwise_rad)
{
	struct pen p = site_pen(s, x, y, site_ground(s, x, y), clockwise_rad);
	p.object = site_object(s, class);
	return p;
}

struct pen site_model(struct site *s, uint32_t *ret_model)
{
	struct mesh *m = g_new0(struct mesh, 1);
	mesh_init(m);
	g_ptr_array_add(s->models, m);
	*ret_model = s->models->len - 1;
	return (struct pen){ .mesh = m, .at = FRAME_WORLD };
}

void site_place(struct site *s, uint32_t model, const struct pen *at)
{
	struct placement p = { at->at, model, at->object };
	g_array_append_val(s->placements, p);
}

float site_ground(const struct site *s, float x, float y)
{
	return s->ground ? s->ground(s, x, y) : 0;
}

bool site_is_free(const struct site *s, float x, float y, float radius)
{
	for (guint i = 0; i < s->claims->len; i++) {
		struct disc d = g_array_index(s->claims, struct disc, i);
		if (hypotf(d.x - x, d.y - y) < d.radius + radius)
			return false;
	}
	return true;
}

bool site_claim(struct site *s, float x, float y, float radius)
{
	if (!site_is_free(s, x, y, radius))
		return false;
	g_array_append_val(s->claims, ((struct disc){ x, y, radius }));
	return true;
}

void site_walk_to(struct site *s, float x, float y)
{
	g_array_append_val(s->walk, ((vec){ x, y, 0, 0 }));
	g_array_append_val(s->claims, ((struct disc){ x, y, 1.9f }));
}

float site_from_walk(const struct site *s, float x, float y)
{
	float near = INFINITY;
	for (guint i = 0; i < s->walk->len; i++) {
		vec at = g_array_index(s->walk, vec, i);
		near = MIN(near, hypotf(at[0] - x, at[1] - y));
	}
	return near;
}
