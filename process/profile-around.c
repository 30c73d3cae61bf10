#include "process/profile-around.h"
#include "process/vector3.h"
#include <json-glib/json-glib.h>
#include <string.h>

#define CELL_M PROFILE_AROUND_LAYER_M
/* How far apart beams are, the median of one point in so many of those that face the scanner. */
#define BEAM_STEP     7u
#define BEAM_STEP_RAD 2e-5
#define BEAMS         2048
#define BEAM_POINTS   50u
#define FACING_COS    0.5
/* The closest quarter, of one point in so many, may be so far apart. */
#define UNIT_SPACING_M 0.04
#define UNIT_SHARE     0.25
#define UNIT_STEP      7u

struct stored {
	float at_m[3];
	int16_t normal[2];
	uint16_t spacing, error, scan;
	uint8_t flags, is_feature;
};

/* Four cubes each way, so many bits of a number. Most cubes near a surface are empty: a bit says so of 64 with one look into the table. */
#define BLOCK_BITS 2
/* Blocks on either side of the origin: 262 km. */
#define BLOCKS_HALF (1 << 20)
struct block {
	uint64_t key; /* UINT64_MAX: none */
	uint64_t has; /* which cubes have points */
	uint32_t
		first; /* of those its first, in their own order; while filling, which block it was */
};

struct profile_around {
	uint32_t mask, blocks;
	struct block *block; /* a hash table */
	uint32_t *begin;     /* of each cube with points, block by block, its first; one more */
	struct stored *
		stored; /* cube by cube, blocks in the order in which the model comes to them: what is near is near */
	GArray *stations; /* of struct profile_station */
};

static int32_t cell_of(float m)
{
	return (int32_t)floorf(m * (1 / CELL_M));
}

static void block_of(const int32_t cell[3], int32_t ret[3])
{
	for (int k = 0; k < 3; k++)
		ret[k] = cell[k] >> BLOCK_BITS;
}

static uint64_t key_of(const int32_t block[3])
{
	uint64_t key = 0;
	for (int k = 0; k < 3; k++)
		key = key << 21 | ((uint32_t)(block[k] + BLOCKS_HALF) & (2 * BLOCKS_HALF - 1));
	return key;
}

/* Which of its block a cube is. */
static unsigned bit_of(const int32_t cell[3])
{
	unsigned bit = 0;
	for (int k = 0; k < 3; k++)
		bit = bit << BLOCK_BITS | ((unsigned)cell[k] & ((1u << BLOCK_BITS) - 1));
	return bit;
}

/* Where it is in the table, or would be. */
static uint32_t slot_of(const profile_around *a, uint64_t key)
{
	uint64_t v = key * 0x9E3779B97F4A7C15u;
	uint32_t slot = (uint32_t)(v >> 32) & a->mask;
	while (a->block[slot].key != key && a->block[slot].key != UINT64_MAX)
		slot = (slot + 1) & a->mask;
	return slot;
}

static void set_table(profile_around *a, uint32_t mask)
{
	a->mask = mask;
	a->block = g_new(struct block, (size_t)mask + 1);
	for (uint32_t n = 0; n <= mask; n++)
		a->block[n] = (struct block){ UINT64_MAX, 0, 0 };
}

static void widen_table(profile_around *a)
{
	struct block *was = a->block;
	uint32_t mask = a->mask;
	set_table(a, 2 * mask + 1);
	for (uint32_t n = 0; n <= mask; n++)
		if (was[n].key != UINT64_MAX)
			a->block[slot_of(a, was[n].key)] = was[n];
	g_free(was);
}

static void add_cell(profile_around *a, const int32_t cell[3])
{
	int32_t block[3];
	block_of(cell, block);
	uint64_t key = key_of(block);
	struct block *b = &a->block[slot_of(a, key)];
	b->has |= 1ull << bit_of(cell);
	if (b->key == key)
		return;
	b->key = key;
	b->first = a->blocks++;
	if (a->blocks > a->mask / 2)
		widen_table(a);
}

/* From which block it was to which its first cube is; returns how many cubes there are. */
static uint32_t number_cells(profile_around *a)
{
	g_autofree uint32_t *first = g_new0(uint32_t, a->blocks + 1);
	for (uint32_t n = 0; n <= a->mask; n++)
		if (a->block[n].key != UINT64_MAX)
			first[a->block[n].first + 1] =
				(uint32_t)__builtin_popcountll(a->block[n].has);
	for (uint32_t n = 0; n < a->blocks; n++)
		first[n + 1] += first[n];
	for (uint32_t n = 0; n <= a->mask; n++)
		if (a->block[n].key != UINT64_MAX)
			a->block[n].first = first[a->block[n].first];
	return first[a->blocks];
}

/* Of a cube that has points. */
static uint32_t number_of(const struct block *b, unsigned bit)
{
	uint64_t before = (1ull << bit) - 1;
	return b->first + (uint32_t)__builtin_popcountll(b->has & before);
}

static uint32_t find_number(const profile_around *a, const int32_t cell[3])
{
	int32_t block[3];
	block_of(cell, block);
	return number_of(&a->block[slot_of(a, key_of(block))], bit_of(cell));
}

/* What a copy is made from. */
struct source {
	const model *m;
	const double *origin_m;
	double unit_m;
};

static struct stored stored_of(
	const struct source *of, const struct model_chunk *c, const struct model_point *p)
{
	struct stored s = { .spacing = (uint16_t)lrint(p->spacing / of->unit_m),
		.error = p->plane_error == MODEL_ERROR_NONE
				 ? MODEL_ERROR_NONE
				 : (uint16_t)lrint(p->plane_error / of->unit_m),
		.scan = p->scan,
		.flags = p->flags,
		.is_feature = p->kind >= FEATURE_UNDIRECTED };
	for (int k = 0; k < 3; k++)
		s.at_m[k] = (float)((c->centre_m[k] - of->origin_m[k] + (double)p->position_m[k]) /
				    of->unit_m);
	memcpy(s.normal, p->normal, sizeof s.normal);
	return s;
}

enum pass { CELLS, COUNTS, POINTS };

/* Which cubes there are, how many points each has, and then each point in its place. */
static void fill(profile_around *a, const struct source *of, enum pass pass)
{
	uint64_t chunks;
	const struct model_chunk *chunk = model_chunks(of->m, &chunks);
	for (uint64_t n = 0; n < chunks; n++) {
		const struct model_point *p = model_points(of->m) + chunk[n].first;
		for (uint32_t i = 0; i < chunk[n].points; i++) {
			struct stored s = stored_of(of, &chunk[n], &p[i]);
			const int32_t cell[3] = { cell_of(s.at_m[0]), cell_of(s.at_m[1]),
				cell_of(s.at_m[2]) };
			if (pass == CELLS) {
				add_cell(a, cell);
				continue;
			}
			uint32_t number = find_number(a, cell);
			if (pass == COUNTS)
				a->begin[number + 1]++;
			else
				a->stored[a->begin[number]++] = s;
		}
		product_forget(model_file(of->m), p, chunk[n].points * sizeof *p);
	}
}

static void copy_points(profile_around *a, const struct source *of)
{
	set_table(a, (1u << 16) - 1);
	fill(a, of, CELLS);
	uint32_t cells = number_cells(a);
	a->begin = g_new0(uint32_t, cells + 2);
	fill(a, of, COUNTS);
	for (uint32_t n = 0; n < cells; n++)
		a->begin[n + 1] += a->begin[n];
	a->stored = g_new(struct stored, model_count(of->m) + 1);
	fill(a, of, POINTS);
	/* Each begins now where the next one should. */
	memmove(a->begin + 1, a->begin, cells * sizeof *a->begin);
	a->begin[0] = 0;
}

/* ---- stations ---- */

static JsonArray *array_in(JsonObject *o, const char *key)
{
	JsonNode *node = json_object_get_member(o, key);
	return node && JSON_NODE_HOLDS_ARRAY(node) ? json_node_get_array(node) : NULL;
}

/* As the model's manifest has the poses of what it was made from: nine numbers of a rotation, three of the place. */
static void read_stations(profile_around *a, const struct source *of)
{
	JsonArray *scans = array_in(product_manifest(model_file(of->m)), "made_from");
	a->stations = g_array_new(FALSE, FALSE, sizeof(struct profile_station));
	for (guint n = 0; scans && n < json_array_get_length(scans); n++) {
		JsonNode *node = json_array_get_element(scans, n);
		JsonObject *scan = JSON_NODE_HOLDS_OBJECT(node) ? json_node_get_object(node) : NULL;
		JsonArray *pose = scan ? array_in(scan, "pose") : NULL;
		if (!pose || json_array_get_length(pose) != 12 ||
			!json_object_get_boolean_member_with_default(scan, "is_station", true))
			continue;
		struct profile_station station = {
			.scan = (uint16_t)json_object_get_int_member_with_default(scan, "scan", 0)
		};
		for (guint k = 0; k < 3; k++) {
			station.at_m[k] =
				(json_array_get_double_element(pose, 9 + k) - of->origin_m[k]) /
				of->unit_m;
			station.up[k] = json_array_get_double_element(pose, 3 * k + 2);
		}
		g_array_append_val(a->stations, station);
	}
}

/* How far apart the beams were between which a point has its part of the surface; 0: it does not tell. */
static double beam_rad_of(const struct profile_station *s, const struct stored *p)
{
	float normal[3];
	double way[3], range = 0, facing = 0, rise = 0;
	model_unpack_normal(p->normal, normal);
	for (int k = 0; k < 3; k++) {
		way[k] = (double)p->at_m[k] - s->at_m[k];
		range += way[k] * way[k];
		facing += way[k] * (double)normal[k];
		rise += way[k] * s->up[k];
	}
	range = sqrt(range);
	double cosine = fabs(facing) / range, level = 1 - rise * rise / (range * range);
	return range > 0 && cosine > FACING_COS && level > 0.1
		       ? (double)p->spacing * 1e-4 * sqrt(cosine) / range / pow(level, 0.25)
		       : 0;
}

static void find_beams(profile_around *a, struct profile_station *s, uint32_t points)
{
	uint32_t count[BEAMS] = { 0 }, all = 0, sum = 0;
	for (uint32_t i = 0; i < points; i += BEAM_STEP) {
		double rad = a->stored[i].scan == s->scan ? beam_rad_of(s, &a->stored[i]) : 0;
		if (rad > 0) {
			count[MIN((int)(rad / BEAM_STEP_RAD), BEAMS - 1)]++;
			all++;
		}
	}
	int n = 0;
	for (; n + 1 < BEAMS && 2 * (sum + count[n]) < all; n++)
		sum += count[n];
	s->beam_rad = all >= BEAM_POINTS && n + 1 < BEAMS ? (n + 0.5) * BEAM_STEP_RAD : 0;
}

bool profile_around_station(const profile_around *a, uint16_t scan, struct profile_station *ret)
{
	for (guint n = 0; n < a->stations->len; n++) {
		const struct profile_station *s =
			&g_array_index(a->stations, struct profile_station, n);
		if (s->scan == scan) {
			*ret = *s;
			return true;
		}
	}
	return false;
}

double profile_unit_m(const model *m)
{
	g_autofree uint32_t *count = g_new0(uint32_t, UINT16_MAX + 1);
	uint32_t all = 0, sum = 0, closest = 0;
	for (uint64_t i = 0; i < model_count(m); i += UNIT_STEP, all++)
		count[model_points(m)[i].spacing]++;
	while (closest < UINT16_MAX && (sum += count[closest]) < UNIT_SHARE * all)
		closest++;
	return fmax(1e-4 * closest / UNIT_SPACING_M, 1);
}

profile_around *profile_around_new(const model *m, const double origin_m[3], double unit_m)
{
	const struct source of = { m, origin_m, unit_m };
	profile_around *a = g_new0(profile_around, 1);
	read_stations(a, &of);
	copy_points(a, &of);
	for (guint n = 0; n < a->stations->len; n++)
		find_beams(a, &g_array_index(a->stations, struct profile_station, n),
			(uint32_t)model_count(m));
	return a;
}

void profile_around_free(profile_around *a)
{
	if (!a)
		return;
	g_free(a->block);
	g_free(a->begin);
	g_free(a->stored);
	g_array_unref(a->stations);
	g_free(a);
}

/* ---- what is around ---- */

struct query {
	const struct profile_frame *frame;
	float at[3], from_m, to_m, radius_m;
	int axis; /* that the line runs along the most; layers are across it */
	int32_t first, last, step;
	GArray *found;
};

static void look_at(const struct query *q, const struct stored *s)
{
	const struct profile_frame *f = q->frame;
	float off[3], normal[3];
	struct profile_near near;
	for (int k = 0; k < 3; k++)
		off[k] = s->at_m[k] - q->at[k];
	near.t = vector3_dot(off, f->axis[2]);
	near.u = vector3_dot(off, f->axis[0]);
	near.v = vector3_dot(off, f->axis[1]);
	if (near.t < q->from_m || near.t > q->to_m ||
		near.u * near.u + near.v * near.v > q->radius_m * q->radius_m)
		return;
	model_unpack_normal(s->normal, normal);
	for (int k = 0; k < 3; k++)
		near.normal[k] = vector3_dot(normal, f->axis[k]);
	near.spacing_m = (float)s->spacing * 1e-4f;
	near.error_m = s->error == MODEL_ERROR_NONE ? NAN : (float)s->error * 1e-4f;
	near.flags = s->flags;
	near.is_feature = s->is_feature;
	near.scan = s->scan;
	g_array_append_val(q->found, near);
}

/* Whether the middle of the cube is so near to the line that some of it may be. */
static bool is_near(const struct query *q, const int32_t cell[3])
{
	float off[3], square = 0, reach = q->radius_m + 0.867f * CELL_M;
	for (int k = 0; k < 3; k++)
		off[k] = ((float)cell[k] + 0.5f) * CELL_M - q->at[k];
	float t = vector3_dot(off, q->frame->axis[2]);
	for (int k = 0; k < 3; k++)
		square += (off[k] - t * q->frame->axis[2][k]) * (off[k] - t * q->frame->axis[2][k]);
	return square <= reach * reach;
}

/* Which cubes of the blocks that lie so far along the axis are in the layers that are asked for. */
static uint64_t layers_in(const struct query *q, int32_t block)
{
	/* As bit_of() counts: of the first layer across each axis, and how far it is to the next one. */
	static const uint64_t layer[3] = { 0xffff, 0x000f000f000f000f, 0x1111111111111111 };
	const int far[3] = { 16, 4, 1 };
	uint64_t ret = 0;
	for (int n = 0; n < 1 << BLOCK_BITS; n++) {
		int32_t at = block * (1 << BLOCK_BITS) + n;
		if (at >= q->first && at <= q->last && (at - q->first) % q->step == 0)
			ret |= layer[q->axis] << n * far[q->axis];
	}
	return ret;
}

static void look_in(
	const profile_around *a, const struct query *q, const int32_t block[3], uint64_t layers)
{
	const struct block *b = &a->block[slot_of(a, key_of(block))];
	for (uint64_t left = b->has & layers; left; left &= left - 1) {
		unsigned bit = (unsigned)__builtin_ctzll(left);
		int32_t cell[3];
		for (int k = 0; k < 3; k++)
			cell[k] = block[k] * (1 << BLOCK_BITS) +
				  (int32_t)(bit >> (2 - k) * BLOCK_BITS & ((1 << BLOCK_BITS) - 1));
		if (!is_near(q, cell))
			continue;
		uint32_t number = number_of(b, bit);
		for (uint32_t i = a->begin[number]; i < a->begin[number + 1]; i++)
			look_at(q, &a->stored[i]);
	}
}

/* In the blocks that lie so far along the axis: those around the line. */
static void look_across(const profile_around *a, const struct query *q, int32_t along)
{
	const float block_m = CELL_M * (1 << BLOCK_BITS), *way = q->frame->axis[2];
	const float middle_m = ((float)along + 0.5f) * block_m - q->at[q->axis];
	int32_t low[3], high[3], block[3];
	for (int k = 0; k < 3; k++) {
		/* Where the line is amid them; aside of that it slants, and so does its disc. */
		float slope = way[k] / way[q->axis], at = q->at[k] + slope * middle_m,
		      reach = q->radius_m * sqrtf(1 + slope * slope) + fabsf(slope) * block_m / 2;
		low[k] = k == q->axis ? along : cell_of(at - reach) >> BLOCK_BITS;
		high[k] = k == q->axis ? along : cell_of(at + reach) >> BLOCK_BITS;
	}
	uint64_t layers = layers_in(q, along);
	for (block[0] = low[0]; layers && block[0] <= high[0]; block[0]++)
		for (block[1] = low[1]; block[1] <= high[1]; block[1]++)
			for (block[2] = low[2]; block[2] <= high[2]; block[2]++)
				look_in(a, q, block, layers);
}

/* Layer by layer of the cubes across the axis that the line runs along the most, those of a block together. */
void profile_around_look(const profile_around *a, const struct profile_frame *f, double from_m,
	double to_m, float radius_m, uint32_t step, GArray *ret)
{
	struct query q = { .frame = f,
		.from_m = (float)from_m,
		.to_m = (float)to_m,
		.radius_m = radius_m,
		.step = (int32_t)step,
		.found = ret };
	float ends[2];
	g_array_set_size(ret, 0);
	for (int k = 0; k < 3; k++) {
		q.at[k] = (float)f->at[k];
		if (fabsf(f->axis[2][k]) > fabsf(f->axis[2][q.axis]))
			q.axis = k;
	}
	for (int e = 0; e < 2; e++)
		ends[e] = q.at[q.axis] + (e ? q.to_m : q.from_m) * f->axis[2][q.axis];
	/* A disc around an end reaches so much further along the axis. */
	float past = radius_m * sqrtf(fmaxf(1 - f->axis[2][q.axis] * f->axis[2][q.axis], 0));
	q.first = cell_of(fminf(ends[0], ends[1]) - past);
	q.last = cell_of(fmaxf(ends[0], ends[1]) + past);
	for (int32_t n = q.first >> BLOCK_BITS; n <= q.last >> BLOCK_BITS; n++)
		look_across(a, &q, n);
}
