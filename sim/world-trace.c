#include "sim/world-trace.h"

#include <stdalign.h>

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

static const struct mesh *mesh_of(const struct world *w, const struct RTCHit *e)
{
	if (e->instID[0] == RTC_INVALID_GEOMETRY_ID)
		return e->geomID == GLASS_MESH ? &w->site.glass : &w->site.solid;
	guint i = e->instID[0] - FIRST_PLACEMENT;
	return model_of(w, g_array_index(w->site.placements, struct placement, i).model);
}

static void describe(const struct world *w, const struct ray *r, float range_m,
	const struct RTCHit *e, bool smooth, struct hit *h)
{
	const struct mesh *m = mesh_of(w, e);
	struct face f = g_array_index(m->faces, struct face, e->primID);
	h->range_m = range_m;
	h->place = r->origin + r->direction * range_m;
	h->material = &g_array_index(w->site.materials, struct material, f.material);
	h->object = f.object;
	h->face = e->primID / 2;
	h->normal = (vec){ e->Ng_x, e->Ng_y, e->Ng_z };
	h->shading = smooth ? smooth_normal(m, e) : h->normal;
	if (e->instID[0] != RTC_INVALID_GEOMETRY_ID) {
		guint i = e->instID[0] - FIRST_PLACEMENT;
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

bool trace_all(const struct world *w, const struct ray *r, bool smooth, struct hit *ret_hit)
{
	struct RTCRayHit e;
	if (!trace(w->all, r, &e))
		return false;
	describe(w, r, e.ray.tfar, &e.hit, smooth, ret_hit);
	return true;
}

bool trace_solid(const struct world *w, const struct ray *r, bool smooth, struct hit *ret_hit)
{
	struct RTCRayHit e;
	if (!trace(w->solid, r, &e))
		return false;
	describe(w, r, e.ray.tfar, &e.hit, smooth, ret_hit);
	return true;
}

bool hit_is_clear(const struct hit *h)
{
	return h->material->kind == MATERIAL_GLASS || h->material->kind == MATERIAL_WATER;
}

/* Lanes that are not meant are filled with one that is: where Embree has no AVX it checks them all. */
static void rays_into(const struct ray *r, unsigned lanes, int valid[PACKET], struct RTCRay8 *e)
{
	for (unsigned i = 0; i < PACKET; i++) {
		valid[i] = lanes >> i & 1 ? -1 : 0;
		const struct ray *one = r + (valid[i] ? i : (unsigned)__builtin_ctz(lanes));
		e->org_x[i] = one->origin[0], e->org_y[i] = one->origin[1],
		e->org_z[i] = one->origin[2];
		e->dir_x[i] = one->direction[0], e->dir_y[i] = one->direction[1],
		e->dir_z[i] = one->direction[2];
		e->tnear[i] = 0, e->tfar[i] = one->limit_m;
		e->time[i] = 0, e->mask[i] = ~0U, e->flags[i] = 0, e->id[i] = i;
	}
}

static enum RTCIntersectContextFlags context_flags(enum packet_kind kind)
{
	return kind == PACKET_LOOK ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT
				   : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
}

static void packet(RTCScene scene, const struct ray *r, unsigned lanes, enum packet_kind kind,
	struct RTCRayHit8 *e)
{
	alignas(32) int valid[PACKET];
	struct RTCIntersectContext context;
	rtcInitIntersectContext(&context);
	context.flags = context_flags(kind);
	rays_into(r, lanes, valid, &e->ray);
	for (unsigned i = 0; i < PACKET; i++)
		e->hit.geomID[i] = e->hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
	rtcIntersect8(valid, scene, &context, e);
}

static struct RTCHit hit_of_lane(const struct RTCHit8 *e, unsigned i)
{
	return (struct RTCHit){ .Ng_x = e->Ng_x[i],
		.Ng_y = e->Ng_y[i],
		.Ng_z = e->Ng_z[i],
		.u = e->u[i],
		.v = e->v[i],
		.primID = e->primID[i],
		.geomID = e->geomID[i],
		.instID = { e->instID[0][i] } };
}

static unsigned packet_hits(const struct world *w, RTCScene scene, const struct ray *r,
	unsigned lanes, enum packet_kind kind, struct hit *ret_hit)
{
	struct RTCRayHit8 e;
	unsigned hits = 0;
	if (!lanes)
		return 0;
	packet(scene, r, lanes, kind, &e);
	for (unsigned i = 0; i < PACKET; i++) {
		const struct RTCHit one = hit_of_lane(&e.hit, i);
		if (!(lanes >> i & 1) || one.geomID == RTC_INVALID_GEOMETRY_ID)
			continue;
		describe(w, r + i, e.ray.tfar[i], &one, kind == PACKET_LOOK, ret_hit + i);
		hits |= 1U << i;
	}
	return hits;
}

unsigned packet_all(const struct world *w, const struct ray *r, unsigned lanes, struct hit *ret_hit)
{
	return packet_hits(w, w->all, r, lanes, PACKET_LOOK, ret_hit);
}

unsigned packet_solid(const struct world *w, const struct ray *r, unsigned lanes,
	enum packet_kind kind, struct hit *ret_hit)
{
	return packet_hits(w, w->solid, r, lanes, kind, ret_hit);
}

void packet_distance(const struct world *w, const struct ray *r, unsigned lanes, float *ret_m)
{
	struct RTCRayHit8 e;
	if (!lanes)
		return;
	packet(w->solid, r, lanes, PACKET_LOOK, &e);
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1)
			ret_m[i] = e.ray.tfar[i];
}

unsigned packet_blocked(
	const struct world *w, const struct ray *r, unsigned lanes, enum packet_kind kind)
{
	alignas(32) int valid[PACKET];
	struct RTCIntersectContext context;
	struct RTCRay8 e;
	unsigned blocked = 0;
	if (!lanes)
		return 0;
	rtcInitIntersectContext(&context);
	context.flags = context_flags(kind);
	rays_into(r, lanes, valid, &e);
	rtcOccluded8(valid, w->solid, &context, &e);
	for (unsigned i = 0; i < PACKET; i++)
		if (lanes >> i & 1 && e.tfar[i] < 0)
			blocked |= 1U << i;
	return blocked;
}

float hit_footprint(const struct ray *r, const struct hit *h)
{
	float slant = -dot(r->direction, h->normal);
	return PIXEL_RAD * h->range_m / (slant < 0.1f ? 0.1f : slant);
}
