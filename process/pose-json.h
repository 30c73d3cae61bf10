#ifndef PROCESS_POSE_JSON_H
#define PROCESS_POSE_JSON_H
/* Poses and rows of numbers in JSON: { "rotation": [[...],[...],[...]], "translation_m": [x, y, z] }. */
#include "process/pose.h"
#include <glib.h>
#include <stddef.h>

typedef struct _JsonNode JsonNode;

/* An array of exactly count numbers, all finite; node may be NULL. */
bool json_read_numbers(JsonNode *node, size_t count, double *ret);
JsonNode *json_write_numbers(const double *number, size_t count); /* what is not finite becomes 0 */

/* A pose whose rotation is one to within 1e-4, made exact. */
bool json_read_pose(JsonNode *node, struct pose *ret);
JsonNode *json_write_pose(const struct pose *p);

#endif
