/* Pencil, charcoal, chalk: pigment that the tooth of a paper rubs off. */
#include "render/stroke-media.h"

/* Heights of a paper under the stroke, 0..1 and about evenly so: the share that lies above 1 - p
 * is about p. Coarse grain is what is left to see where a stroke is drawn small, fine grain what
 * one sees of a large one. */
static float tooth(const struct stroke_place *at, float coarse, float fine, uint32_t seed)
{
	float n = 2.1f * media_noise(at, coarse, coarse, seed) +
		  1.3f * media_noise(at, fine, fine, seed + 1) +
		  0.7f * (grain_unit((uint32_t)at->x, (uint32_t)at->y, seed + 2) - 0.5f);
	return 0.5f + 0.5f * n / sqrtf(1 + n * n);
}

/* Pigment where the pressure is p and the paper so high: the softer a medium, the further it gets
 * into the hollows. */
static float rubbed(float pressure, float height, float softness)
{
	return grain_step(-softness, softness, height - (1 - pressure));
}

/* Lines that a hard crumb or a facet of the point leaves, along the stroke: 0..1. */
static float streaks(const struct stroke_place *at, float length, float width, uint32_t seed)
{
	return 0.5f + 0.5f * fminf(1, fmaxf(-1, 2.2f * media_noise(at, length, width, seed)));
}

/* Pressure from where the point touches down to where it is lifted. */
static float touch(float along, float down, float lift)
{
	return grain_step(0, down, along) * grain_step(1, 1 - lift, along);
}

/* A cone of graphite: most pressure in the middle; it is lifted slowly, and where it is light the
 * line is thinner, too. */
float stroke_pencil(const struct stroke_place *at, uint32_t seed)
{
	float press =
		touch(at->along, 0.14f, 0.45f) * (0.88f + 0.4f * media_noise(at, 60, 1e3f, seed));
	float sway = 0.18f * media_noise(at, 110, 1e3f, seed + 3);
	float half = 0.2f + 0.56f * press;
	float edge = grain_step(half * 1.2f, half * 0.3f, fabsf(at->across - sway));
	float streak = streaks(at, 75, 2.4f, seed + 4);
	float pressure = press * edge * (0.7f + 0.35f * streak);
	float graphite = rubbed(pressure, tooth(at, 5.5f, 2.6f, seed + 5), 0.3f);
	return fminf(1, 3 * pressure) * (0.4f + 0.5f * pressure) * graphite;
}

/* A blunt stick: it covers its middle, breaks up into grains beside it, and its dust gets
 * everywhere below. */
float stroke_charcoal(const struct stroke_place *at, uint32_t seed)
{
	float ragged =
		0.2f * media_noise(at, 20, 9, seed) + 0.12f * media_noise(at, 6, 5, seed + 1);
	float ends = touch(at->along + 0.14f * media_noise(at, 16, 7, seed + 2), 0.1f, 0.16f);
	float press = ends * (0.95f + 0.35f * media_noise(at, 50, 1e3f, seed + 3));
	float edge = grain_step(1.02f, 0.3f, fabsf(at->across) + ragged);
	float streak = streaks(at, 65, 3.2f, seed + 4);
	float pressure = fminf(1, press * edge * (0.52f + 0.5f * streak));
	float dust = 0.3f * press * edge * (0.6f + 0.4f * streak);
	float grains = rubbed(pressure, tooth(at, 6.5f, 2.8f, seed + 5), 0.2f);
	return dust + (0.9f - dust) * grains * fminf(1, 4 * pressure);
}

/* Too hard to get into the hollows at all: paper shows through everywhere, and what is covered is
 * so wholly. A piece of chalk lies on one of its edges, where it leaves more. */
float stroke_chalk(const struct stroke_place *at, uint32_t seed)
{
	float ragged =
		0.14f * media_noise(at, 24, 9, seed) + 0.14f * media_noise(at, 7, 6, seed + 1);
	float blunt = touch(at->along + 0.04f * media_noise(at, 12, 5, seed + 2), 0.035f, 0.05f);
	float edge = grain_step(1.02f, 0.68f, fabsf(at->across) + ragged);
	float tilt = 0.14f * at->across * (grain_unit(0, 0, seed + 3) < 0.5f ? -1.0f : 1.0f);
	float press = 0.53f + tilt + 0.4f * media_noise(at, 40, 16, seed + 4);
	float streak = streaks(at, 60, 3, seed + 5);
	float pressure = blunt * edge * press * (0.5f + 0.8f * streak);
	return 0.04f * blunt * edge + 0.82f * rubbed(pressure, tooth(at, 6, 2.8f, seed + 6), 0.12f);
}
