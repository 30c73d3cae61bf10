#include "render/light.h"
#include <glib.h>

static uint8_t srgb[LIGHT_STEPS + LIGHT_BEHIND];
static float linear[256];
/* One more, for what lies between them. */
static float srgb_steps[LIGHT_STEPS + 1], linear_steps[LIGHT_STEPS + 1];

static void make(void)
{
	for (int n = 0; n < LIGHT_STEPS; n++)
		srgb[n] = (uint8_t)(255 * light_to_srgb((float)n / (LIGHT_STEPS - 1)) + 0.5f);
	for (int n = 0; n < 256; n++)
		linear[n] = light_of_srgb((float)n / 255);
	for (int n = 0; n <= LIGHT_STEPS; n++) {
		srgb_steps[n] = light_to_srgb((float)n / (LIGHT_STEPS - 1));
		linear_steps[n] = light_of_srgb((float)n / (LIGHT_STEPS - 1));
	}
}

static void make_once(void)
{
	static gsize made;
	if (g_once_init_enter(&made)) {
		make();
		g_once_init_leave(&made, 1);
	}
}

const uint8_t *light_srgb_bytes(void)
{
	make_once();
	return srgb;
}

const float *light_of_bytes(void)
{
	make_once();
	return linear;
}

const float *light_srgb_steps(void)
{
	make_once();
	return srgb_steps;
}

const float *light_of_steps(void)
{
	make_once();
	return linear_steps;
}
