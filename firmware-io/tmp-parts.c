#include "firmware-io/parts.h"
camera *camera_new_v4l2(head *h, const parts *p, GError **error)
{
	(void)h;
	(void)p;
	(void)error;
	return NULL;
}
