#include "process/scan-moves.h"
#include <json-glib/json-glib.h>

#define STILL_M   5e-5
#define STILL_RAD (0.0005 * G_PI / 180)

static const struct placed_scan *find(const GArray *scans, uint32_t number)
{
	for (guint i = 0; i < scans->len; i++) {
		const struct placed_scan *p = &g_array_index(scans, struct placed_scan, i);
		if (p->number == number)
			return p;
	}
	return NULL;
}

/* false: it stayed. */
static bool compare(
	const struct placed_scan *before, const struct placed_scan *after, struct scan_move *ret)
{
	uint32_t was = before ? before->group : 0, is = after->group;
	*ret = (struct scan_move){ .number = after->number, .group = is };
	if (!was || !is) {
		ret->kind = is ? SCAN_PLACED : SCAN_NOT_PLACED;
		return was != is;
	}
	if (was != is) {
		ret->kind = SCAN_OF_GROUP;
		return true;
	}
	struct pose d = pose_between(&before->pose, &after->pose);
	ret->kind = SCAN_MOVED;
	ret->m = pose_distance_m(&d);
	ret->rad = pose_angle_rad(&d);
	return ret->m > STILL_M || ret->rad > STILL_RAD;
}

GArray *scan_moves(const GArray *before, const GArray *after)
{
	GArray *moves = g_array_new(FALSE, FALSE, sizeof(struct scan_move));
	for (guint i = 0; i < after->len; i++) {
		const struct placed_scan *p = &g_array_index(after, struct placed_scan, i);
		struct scan_move m;
		if (compare(find(before, p->number), p, &m))
			g_array_append_val(moves, m);
	}
	for (guint i = 0; i < before->len; i++) {
		const struct placed_scan *p = &g_array_index(before, struct placed_scan, i);
		struct scan_move gone = { .number = p->number, .kind = SCAN_NOT_PLACED };
		if (p->group && !find(after, p->number))
			g_array_append_val(moves, gone);
	}
	return moves;
}

char *scan_move_text(const struct scan_move *m)
{
	switch (m->kind) {
	case SCAN_PLACED:
		return g_strdup_printf("scan %u is placed now, in group %u", m->number, m->group);
	case SCAN_NOT_PLACED: return g_strdup_printf("scan %u is not placed any more", m->number);
	case SCAN_OF_GROUP:
		return g_strdup_printf("scan %u is in group %u now", m->number, m->group);
	case SCAN_MOVED: break;
	}
	return g_strdup_printf("scan %u moved by %.1f mm and %.3f degrees", m->number, 1000 * m->m,
		m->rad * 180 / G_PI);
}

JsonArray *scan_moves_json(const GArray *moves)
{
	static const char *const kinds[] = { [SCAN_MOVED] = "moved",
		[SCAN_PLACED] = "placed",
		[SCAN_NOT_PLACED] = "not placed",
		[SCAN_OF_GROUP] = "other group" };
	JsonArray *array = json_array_new();
	for (guint i = 0; i < moves->len; i++) {
		const struct scan_move *m = &g_array_index(moves, struct scan_move, i);
		JsonObject *o = json_object_new();
		json_object_set_int_member(o, "scan", m->number);
		json_object_set_string_member(o, "what", kinds[m->kind]);
		json_object_set_int_member(o, "group", m->group);
		if (m->kind == SCAN_MOVED) {
			json_object_set_double_member(o, "moved_mm", 1000 * m->m);
			json_object_set_double_member(o, "turned_deg", m->rad * 180 / G_PI);
		}
		json_array_add_object_element(array, o);
	}
	return array;
}

guint scan_moves_count_placed(const GArray *scans)
{
	guint count = 0;
	for (guint i = 0; i < scans->len; i++)
		count += g_array_index(scans, struct placed_scan, i).group > 0;
	return count;
}
