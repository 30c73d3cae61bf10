#include "firmware-io/parts.h"
stage *stage_new_pins(head *h, const parts *p, GError **error)
{
	(void)h;
	(void)p;
	(void)error;
	return NULL;
}
camera *camera_new_v4l2(head *h, const parts *p, GError **error)
{
	(void)h;
	(void)p;
	(void)error;
	return NULL;
}
