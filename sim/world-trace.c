#include "sim/world-trace.h"

/* Geometries of both scenes by their numbers. */
enum { SOLID_MESH, GLASS_MESH, FIRST_PLACEMENT };

static struct mesh *model_of(const struct world *w, uint32_t i)
{
	return g_ptr_array_index(w->site.models, i);
}

static RTCGeometry mesh_geometry(RTCDevice device, const struct mesh *m)
{
	RTCGeometry g = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
	rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, m->points->data,
		0, sizeof(vec), m->points->len);
	rtcSetSharedGeometryBuffer(g, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, m->indices->data,
		0, 3 * sizeof(uint32_t), m->faces->len);
	rtcCommitGeometry(g);
	return g;
}

static RTCScene new_scene(RTCDevice device)
{
	RTCScene scene = rtcNewScene(device);
	rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_MEDIUM);
	return scene;
}

static RTCScene model_scene(RTCDevice device, const struct mesh *m)
{
	RTCScene scene = new_scene(device);
	RTCGeometry g = mesh_geometry(device, m);
	rtcAttachGeometryByID(scene, g, 0);
	rtcReleaseGeometry(g);
	rtcCommitScene(scene);
	return scene;
}

static void attach(struct world *w, RTCGeometry g, unsigned id, bool solid)
{
	if (solid)
		rtcAttachGeometryByID(w->solid, g, id);
	rtcAttachGeometryByID(w->all, g, id);
	rtcReleaseGeometry(g);
}

static void place_model(struct world *w, guint i)
{
	const struct placement *p = &g_array_index(w->site.placements, struct placement, i);
	RTCGeometry g = rtcNewGeometry(w->device, RTC_GEOMETRY_TYPE_INSTANCE);
	rtcSetGeometryInstancedScene(g, g_ptr_array_index(w->model_scenes, p->model));
	const vec *column[4] = { &p->at.x, &p->at.y, &p->at.z, &p->at.o };
	float matrix[12];
	for (unsigned k = 0; k < 12; k++)
		matrix[k] = (*column[k / 3])[k % 3];
	rtcSetGeometryTransform(g, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, matrix);
	rtcCommitGeometry(g);
	attach(w, g, FIRST_PLACEMENT + i, true);
	/* the cofactors are the inverse transpose but for a factor, which does not turn normals */
	w->turns[i] = (struct turn){ cross(p->at.y, p->at.z), cross(p->at.z, p->at.x),
		cross(p->at.x, p->at.y) };
}

void trace_commit(struct world *w)
{
	w->device = rtcNewDevice("threads=1,set_affinity=0");
	w->model_scenes = g_ptr_array_new_with_free_func((GDestroyNotify)rtcReleaseScene);
	mesh_finish(&w->site.solid);
	mesh_finish(&w->site.glass);
	for (guint i = 0; i < w->site.models->len; i++) {
		mesh_finish(model_of(w, i));
		g_ptr_array_add(w->model_scenes, model_scene(w->device, model_of(w, i)));
	}
	w->turns = g_new(struct turn, w->site.placements->len + 1);
	w->solid = new_scene(w->device);
	w->all = new_scene(w->device);
	attach(w, mesh_geometry(w->device, &w->site.solid), SOLID_MESH, true);
	attach(w, mesh_geometry(w->device, &w->site.glass), GLASS_MESH, false);
	for (guint i = 0; i < w->site.placements->len; i++)
		place_model(w, i);
	rtcCommitScene(w->solid);
	rtcCommitScene(w->all);
}

void trace_free(struct world *w)
{
	rtcReleaseScene(w->solid);
	rtcReleaseScene(w->all);
	g_ptr_array_unref(w->model_scenes);
	rtcReleaseDevice(w->device);
	g_free(w->turns);
}

static void ray_into(const struct ray *r, struct RTCRay *e)
{
	e->org_x = r->origin[0], e->org_y = r->origin[1], e->org_z = r->origin[2];
	e->dir_x = r->direction[0], e->dir_y = r->direction[1], e->dir_z = r->direction[2];
	e->tnear = 0, e->tfar = r->limit_m;
	e->time = 0, e->mask = ~0U, e->flags = 0, e->id = 0;
}

static bool trace(RTCScene scene, const struct ray *r, struct RTCRayHit *e)
{
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	ray_into(r, &e->ray);
	e->hit.geomID = e->hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
	rtcIntersect1(scene, &context, e);
	return e->hit.geomID != RTC_INVALID_GEOMETRY_ID;
}

static vec smooth_normal(const struct mesh *m, const struct RTCHit *e)
{
	const uint32_t *i = &g_array_index(m->indices, uint32_t, 3 * e->primID);
	const vec *n = (const vec *)m->normals->data;
	return n[i[0]] * (1 - e->u - e->v) + n[i[1]] * e->u + n[i[2]] * e->v;
}

static vec turned(const struct turn *t, vec n)
{
	return t->x * n[0] + t->y * n[1] + t->z * n[2];
}

static void describe(const struct world *w, const struct mesh *m, const struct ray *r,
	const struct RTCRayHit *e, bool smooth, struct hit *h)
{
	struct face f = g_array_index(m->faces, struct face, e->hit.primID);
	h->range_m = e->ray.tfar;
	h->place = r->origin + r->direction * e->ray.tfar;
	h->material = &g_array_index(w->site.materials, struct material, f.material);
	h->object = f.object;
	h->face = e->hit.primID / 2;
	h->normal = (vec){ e->hit.Ng_x, e->hit.Ng_y, e->hit.Ng_z };
	h->shading = smooth ? smooth_normal(m, &e->hit) : h->normal;
	if (e->hit.instID[0] != RTC_INVALID_GEOMETRY_ID) {
		guint i = e->hit.instID[0] - FIRST_PLACEMENT;
		h->object = g_array_index(w->site.placements, struct placement, i).object;
		h->face += i * 0x10001U;
		h->normal = turned(&w->turns[i], h->normal);
		h->shading = turned(&w->turns[i], h->shading);
	}
	h->normal = unit(h->normal);
	h->shading = unit(h->shading);
	if (dot(h->normal, r->direction) > 0)
		h->normal = -h->normal;
	/* a leaf shades as the mass it belongs to, whichever of its sides is seen */
	if (h->material->kind != MATERIAL_LEAF && dot(h->shading, h->normal) < 0)
		h->shading = -h->shading;
}

static const struct mesh *mesh_of(const struct world *w, const struct RTCHit *e)
{
	if (e->instID[0] == RTC_INVALID_GEOMETRY_ID)
		return e->geomID == GLASS_MESH ? &w->site.glass : &w->site.solid;
	guint i = e->instID[0] - FIRST_PLACEMENT;
	return model_of(w, g_array_index(w->site.placements, struct placement, i).model);
}

bool trace_all(const struct world *w, const struct ray *r, bool smooth, struct hit *ret_hit)
{
	struct RTCRayHit e;
	if (!trace(w->all, r, &e))
		return false;
	describe(w, mesh_of(w, &e.hit), r, &e, smooth, ret_hit);
	return true;
}

bool trace_solid(const struct world *w, const struct ray *r, bool smooth, struct hit *ret_hit)
{
	struct RTCRayHit e;
	if (!trace(w->solid, r, &e))
		return false;
	describe(w, mesh_of(w, &e.hit), r, &e, smooth, ret_hit);
	return true;
}

bool hit_is_clear(const struct hit *h)
{
	return h->material->kind == MATERIAL_GLASS || h->material->kind == MATERIAL_WATER;
}

float trace_distance(const struct world *w, const struct ray *r)
{
	struct RTCRayHit e;
	trace(w->solid, r, &e);
	return e.ray.tfar;
}

bool trace_blocked(const struct world *w, const struct ray *r)
{
	struct RTCIntersectContext context;
	struct RTCRay e;
	rtcInitIntersectContext(&context);
	ray_into(r, &e);
	rtcOccluded1(w->solid, &context, &e);
	return e.tfar < 0;
}

float hit_footprint(const struct ray *r, const struct hit *h)
{
	float slant = -dot(r->direction, h->normal);
	return PIXEL_RAD * h->range_m / (slant < 0.1f ? 0.1f : slant);
}
