#ifndef SIM_SCENE_PROPS_H
#define SIM_SCENE_PROPS_H
/* What stands about: street furniture, people and cars. Each is drawn round the pen's origin on the
 * ground, with the pen's object; its front is towards -y. */
#include "sim/scene-palette.h"

void draw_lamp_post(const struct pen *p, const struct palette *m, float height);
/* On a wall that is the plane y = 0 with the viewer at -y. */
void draw_lantern(const struct pen *p, const struct palette *m);
void draw_bench(const struct pen *p, const struct palette *m);
void draw_bollard(const struct pen *p, const struct palette *m);
void draw_fountain(const struct pen *p, const struct palette *m, float radius);
void draw_well(const struct pen *p, const struct palette *m);
void draw_urn(const struct pen *p, float height);
void draw_table(const struct pen *p, const struct palette *m, float radius);
void draw_chair(const struct pen *p, const struct palette *m);
void draw_parasol(const struct pen *p, const struct palette *m, uint16_t cloth);
void draw_bicycle(const struct pen *p, const struct palette *m);
void draw_sign(const struct pen *p, const struct palette *m, uint16_t face, bool round);

enum pose { POSE_STAND, POSE_WALK, POSE_SIT };

/* Faces -y. Sitting, the seat is 0.45 m up and the person's back at about y = 0.2. */
void draw_person(struct site *s, const struct pen *p, enum pose pose);

enum car_kind { CAR_HATCHBACK, CAR_SALOON, CAR_VAN };

/* Its length is along x, the bonnet at +x. */
void draw_car(struct site *s, const struct pen *p, const struct palette *m, enum car_kind kind);

/* The same with a new object on the ground, turned clockwise. */
void add_person(struct site *s, float x, float y, float clockwise_rad, enum pose pose);
void add_car(struct site *s, const struct palette *m, float x, float y, float clockwise_rad);

#endif
