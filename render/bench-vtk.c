#include "render/bench-vtk.h"
#include "firmware-io/files.h"
#include "process/bench-other.h"
#include "process/bench-run.h"
#include <gio/gio.h>
#include <glib/gstdio.h>
#include <json-glib/json-glib.h>
#include <stdio.h>
#include <string.h>

/* Arguments: the points, width, height, then of each camera eye, target, up and field of view. */
static const char program[] =
	"import json, sys, time\n"
	"import vtkmodules.vtkRenderingOpenGL2\n"
	"from vtkmodules.vtkCommonCore import vtkVersion\n"
	"from vtkmodules.vtkFiltersGeneral import vtkVertexGlyphFilter\n"
	"from vtkmodules.vtkIOPLY import vtkPLYReader\n"
	"from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer,\n"
	"                                         vtkRenderWindow)\n"
	"width, height = int(sys.argv[2]), int(sys.argv[3])\n"
	"numbers = [float(a) for a in sys.argv[4:]]\n"
	"cameras = [numbers[i:i + 10] for i in range(0, len(numbers), 10)]\n"
	"reader = vtkPLYReader()\n"
	"reader.SetFileName(sys.argv[1])\n"
	"points = vtkVertexGlyphFilter()\n"
	"points.SetInputConnection(reader.GetOutputPort())\n"
	"points.Update()\n"
	"mapper = vtkPolyDataMapper()\n"
	"mapper.SetInputData(points.GetOutput())\n"
	"actor = vtkActor()\n"
	"actor.SetMapper(mapper)\n"
	"actor.GetProperty().SetPointSize(3)\n"
	"actor.GetProperty().SetLighting(False)\n"
	"renderer = vtkRenderer()\n"
	"renderer.SetBackground(1, 1, 1)\n"
	"renderer.AddActor(actor)\n"
	"window = vtkRenderWindow()\n"
	"window.SetOffScreenRendering(1)\n"
	"window.SetSize(width, height)\n"
	"window.AddRenderer(renderer)\n"
	"def draw():\n"
	"    began = time.monotonic()\n"
	"    window.Render()\n"
	"    window.WaitForCompletion()\n"
	"    return time.monotonic() - began\n"
	"first, means = None, []\n"
	"for c in cameras:\n"
	"    camera = renderer.GetActiveCamera()\n"
	"    camera.SetPosition(c[0:3])\n"
	"    camera.SetFocalPoint(c[3:6])\n"
	"    camera.SetViewUp(c[6:9])\n"
	"    camera.SetViewAngle(c[9])\n"
	"    renderer.ResetCameraClippingRange()\n"
	"    if first is None:\n"
	"        first = draw()\n"
	"    means.append((draw() + draw()) / 2)\n"
	"about = [l for l in window.ReportCapabilities().splitlines() if 'renderer string' in l]\n"
	"print(json.dumps({'version': vtkVersion.GetVTKVersion(), 'first_s': first,\n"
	"                  'frame_s': means, 'points': points.GetOutput().GetNumberOfPoints(),\n"
	"                  'renderer': about[0].split(':', 1)[1].strip() if about else ''}))\n";

/* ---- what it draws ---- */

struct vertex {
	float place_m[3];
	uint8_t rgb[3];
} __attribute__((packed));

static void write_chunk(const scene *s, const struct scene_chunk *c, FILE *to)
{
	for (uint32_t i = 0; i < c->count; i++) {
		double place_m[3];
		const uint8_t *rgba = s->rgba[c->first + i];
		struct vertex v;
		scene_position(s, c, i, place_m);
		for (int k = 0; k < 3; k++) {
			v.place_m[k] = (float)(place_m[k] - s->origin_m[k]);
			v.rgb[k] = rgba[3] ? rgba[k] : 128;
		}
		fwrite(&v, sizeof v, 1, to);
	}
}

static bool write_points(const scene *s, const char *path, GError **error)
{
	FILE *to = fopen(path, "wbe");
	if (!to)
		return files_fail(error, path, "write");
	fprintf(to,
		"ply\nformat binary_little_endian 1.0\nelement vertex %u\n"
		"property float x\nproperty float y\nproperty float z\n"
		"property uchar red\nproperty uchar green\nproperty uchar blue\n"
		"element face 0\nproperty list uchar int vertex_indices\nend_header\n",
		s->count);
	for (uint32_t n = 0; n < s->chunks; n++)
		write_chunk(s, &s->chunk[n], to);
	bool good = !ferror(to);
	return (fclose(to) == 0 && good) || files_fail(error, path, "write");
}

static void add_camera(GPtrArray *argv, const scene *s, const struct camera *c)
{
	double eye[3], target[3], up[3];
	char text[G_ASCII_DTOSTR_BUF_SIZE];
	for (int k = 0; k < 3; k++) {
		eye[k] = c->eye_m[k] - s->origin_m[k];
		target[k] = eye[k] + c->forward[k];
		up[k] = -c->down[k];
	}
	const double *const part[] = { eye, target, up };
	for (int n = 0; n < 9; n++)
		g_ptr_array_add(
			argv, g_strdup(g_ascii_dtostr(text, sizeof text, part[n / 3][n % 3])));
	g_ptr_array_add(argv, g_strdup(g_ascii_dtostr(text, sizeof text, camera_fov_deg(c))));
}

/* ---- all of it ---- */

static bool read_answer(const char *text, uint32_t count, struct bench_vtk *ret, GError **error)
{
	g_autoptr(JsonParser) parser = json_parser_new();
	if (!json_parser_load_from_data(parser, text, -1, error))
		return false;
	JsonObject *o = json_node_get_object(json_parser_get_root(parser));
	JsonArray *frames = json_object_get_array_member(o, "frame_s");
	ret->version = g_strdup(json_object_get_string_member(o, "version"));
	ret->renderer = g_strdup(json_object_get_string_member(o, "renderer"));
	ret->first_s = json_object_get_double_member(o, "first_s");
	ret->cameras = MIN(count, json_array_get_length(frames));
	for (uint32_t n = 0; n < ret->cameras; n++)
		ret->frame_s[n] = json_array_get_double_element(frames, n);
	return true;
}

static GPtrArray *command_of(const scene *s, const struct bench_camera *cameras, uint32_t count,
	const char *python, const char *points)
{
	g_autofree char *xvfb = g_find_program_in_path("xvfb-run");
	GPtrArray *argv = g_ptr_array_new_with_free_func(g_free);
	if (xvfb) {
		g_ptr_array_add(argv, g_steal_pointer(&xvfb));
		g_ptr_array_add(argv, g_strdup("-a"));
	}
	const char *const words[] = { python, "-c", program, points };
	for (size_t n = 0; n < G_N_ELEMENTS(words); n++)
		g_ptr_array_add(argv, g_strdup(words[n]));
	g_ptr_array_add(argv, g_strdup_printf("%u", cameras->camera.width));
	g_ptr_array_add(argv, g_strdup_printf("%u", cameras->camera.height));
	for (uint32_t n = 0; n < count; n++)
		add_camera(argv, s, &cameras[n].camera);
	g_ptr_array_add(argv, NULL);
	return argv;
}

static bool run(const scene *s, const struct bench_camera *cameras, uint32_t count,
	const char *python, const char *folder, struct bench_vtk *ret, GError **error)
{
	g_autofree char *points = g_build_filename(folder, "points.ply", NULL);
	struct bench_run ran = { 0 };
	if (!write_points(s, points, error))
		return false;
	g_autoptr(GPtrArray) argv = command_of(s, cameras, count, python, points);
	bool good = bench_run((const char *const *)argv->pdata, &ran, error) &&
		    read_answer(ran.output, count, ret, error);
	g_free(ran.output);
	g_unlink(points);
	return good;
}

void bench_vtk_run(const scene *s, const struct bench_camera *cameras, uint32_t count,
	const char *folder, struct bench_vtk *ret)
{
	g_autoptr(GError) error = NULL;
	g_autofree char *xvfb = g_find_program_in_path("xvfb-run");
	const char *python = bench_python("vtkmodules.vtkRenderingOpenGL2, vtkmodules.vtkIOPLY");
	*ret = (struct bench_vtk){ 0 };
	g_assert(count <= BENCH_VTK_CAMERAS_MAX);
	if (!python)
		ret->why_not = g_strdup("the package python3-vtk9 is not installed");
	else if (!xvfb && !g_getenv("DISPLAY"))
		ret->why_not =
			g_strdup("it needs a display, and the package xvfb is not installed");
	else if (!run(s, cameras, count, python, folder, ret, &error))
		ret->why_not = g_strdup(error->message);
}

void bench_vtk_clear(struct bench_vtk *v)
{
	g_free(v->why_not);
	g_free(v->version);
	g_free(v->renderer);
}
