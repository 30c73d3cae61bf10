/* Ink and brush, whose strokes have an outline; and the two that are of no hand. */
#include "render/stroke-media.h"

/* ---- of no hand ---- */

/* Falls to 0 at the circle, since exp alone never does. */
float stroke_gaussian(const struct stroke_place *at, uint32_t seed)
{
	(void)seed;
	float u = 2 * at->along - 1, r2 = u * u + at->across * at->across;
	return r2 < 1 ? (expf(-4 * r2) - expf(-4)) / (1 - expf(-4)) : 0;
}

float stroke_line(const struct stroke_place *at, uint32_t seed)
{
	(void)seed;
	float end = fminf(at->along, 1 - at->along);
	return grain_step(0.95f, 0.45f, fabsf(at->across)) * grain_step(0.004f, 0.05f, end);
}

float stroke_dot(const struct stroke_place *at, uint32_t seed)
{
	(void)seed;
	return grain_step(0.97f, 0.8f, hypotf(2 * at->along - 1, at->across));
}

/* ---- ink pen ---- */

/* Rises from 0 to 1 as a circle does. */
static float rounded(float t)
{
	float rest = t < 0 ? 1 : t > 1 ? 0 : 1 - t;
	return sqrtf(1 - rest * rest);
}

/* Half the width of the line: a round start, a slight swelling under pressure, a fast taper where
 * the nib is lifted. */
static float nib(float along, const struct stroke_place *at, uint32_t seed)
{
	float start = rounded(along / 0.05f), taper = grain_step(1.04f, 0.66f, along);
	float swell = 0.46f + 0.16f * sinf(3.1416f * fminf(1, along / 0.85f));
	return start * taper * (swell + 0.22f * media_noise(at, 70, 1e3f, seed));
}

float stroke_ink_pen(const struct stroke_place *at, uint32_t seed)
{
	float along = (at->x - 3) / (STROKE_TEXTURE_LENGTH - 6);
	if (along <= 0 || along >= 1)
		return 0;
	float sway = 0.14f * media_noise(at, 120, 1e3f, seed + 1);
	float rough = 0.035f * media_noise(at, 5, 5, seed + 2);
	float inside = nib(along, at, seed) - fabsf(at->across - sway) + rough;
	/* The edge is about two texels wide; along it ink gathers as it dries. */
	float body = grain_step(-0.06f, 0.07f, inside), rim = grain_step(0.3f, 0.05f, inside);
	return body * (0.9f + 0.07f * rim + 0.05f * media_noise(at, 40, 12, seed + 3));
}

/* ---- brush ---- */

/* How much ink a bristle has left here: what it took up, less what the way took; below 0 it is
 * dry. Bristles spread and close again, so their streaks are not quite straight. */
static float bristle_load(const struct stroke_place *at, uint32_t seed)
{
	struct stroke_place bent = *at;
	bent.y += 1.6f * media_noise(at, 90, 1e3f, seed);
	float took = 0.62f * media_noise(&bent, 500, 1.7f, seed + 1) +
		     0.55f * media_noise(&bent, 260, 4.5f, seed + 2);
	float skips = 0.35f * media_noise(&bent, 16, 2.2f, seed + 3);
	float left = 1.02f - 1.12f * at->along;
	return left + took + skips * grain_step(0.1f, 0.8f, at->along);
}

/* The outline: round where it is set down, bristle by bristle where it is lifted. */
static float brush_body(const struct stroke_place *at, uint32_t seed)
{
	float along = at->along + 0.1f * media_noise(at, 400, 2.5f, seed) * at->along;
	float start = rounded((along - 0.01f) / 0.07f);
	float half = (0.84f - 0.12f * along + 0.07f * media_noise(at, 60, 1e3f, seed + 1)) * start;
	float side = grain_step(-0.05f, 0.09f, half - fabsf(at->across));
	return side * grain_step(0.99f, 0.9f, along);
}

float stroke_brush(const struct stroke_place *at, uint32_t seed)
{
	float load = bristle_load(at, seed), wet = grain_step(-0.04f, 0.24f, load);
	float tone = 0.62f + 0.3f * grain_step(0, 1.2f, load);
	/* A rim where the ink that was set down dries. */
	float rim =
		0.08f * grain_step(0.5f, 0.85f, fabsf(at->across)) * grain_step(0.5f, 0, at->along);
	return brush_body(at, seed + 4) * wet * (tone + rim);
}

/* ---- paint ---- */

/* What the hairs of a flat brush leave behind: ridges along the stroke that are not quite straight, thicker at the sides, to which paint
 * gives way, and at the end, where it is left. */
static float hairs(const struct stroke_place *at, uint32_t seed)
{
	struct stroke_place bent = *at;
	bent.y += 1.2f * media_noise(at, 110, 1e3f, seed);
	float ridges = 0.5f * media_noise(&bent, 420, 1.9f, seed + 1) +
		       0.45f * media_noise(&bent, 200, 4.2f, seed + 2);
	float side = 0.2f * grain_step(0.45f, 0.8f, fabsf(at->across)),
	      end = 0.18f * grain_step(0.7f, 0.93f, at->along);
	return 0.68f + 0.55f * ridges + side + end;
}

/* Blunt where it is set down, torn where it is lifted. */
static float flat_body(const struct stroke_place *at, uint32_t seed)
{
	float torn = 0.12f * media_noise(at, 1e3f, 3.1f, seed),
	      begun = 0.05f * media_noise(at, 1e3f, 4, seed + 3);
	float half = 0.86f + 0.1f * media_noise(at, 70, 1e3f, seed + 1) - 0.12f * at->along;
	return grain_step(-0.02f, 0.16f, half - fabsf(at->across)) *
	       grain_step(0.015f, 0.07f, at->along + begun) *
	       grain_step(0.985f, 0.86f, at->along + torn);
}

float stroke_bristles(const struct stroke_place *at, uint32_t seed)
{
	float thick = hairs(at, seed), dry = grain_step(0.5f, 1, at->along);
	/* Towards the end hairs run dry. */
	thick -= dry * (0.3f + 0.9f * fmaxf(media_noise(at, 260, 2.6f, seed + 7), 0));
	return flat_body(at, seed + 4) * thick;
}

/* Set down once, round: a touch of a loaded brush, thick at its rim. */
float stroke_dab(const struct stroke_place *at, uint32_t seed)
{
	float u = 2 * at->along - 1;
	float away = hypotf(u, at->across) / (0.88f + 0.22f * media_noise(at, 60, 9, seed));
	float rim = 0.25f * grain_step(0.4f, 0.8f, away);
	float thick = 0.66f + rim + 0.4f * media_noise(at, 90, 3.4f, seed + 1);
	return grain_step(1, 0.78f, away) * thick;
}
