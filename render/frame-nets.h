#ifndef RENDER_FRAME_NETS_H
#define RENDER_FRAME_NETS_H
/* The networks that a drawing's filters ask for ("neural"), each read once and tried. */
#include "process/semantic-net.h"
#include "render/style.h"

typedef struct frame_nets frame_nets;
/* NULL without an error: the drawing has none. Errors name the file: it cannot be read, is no ONNX, or does not make a picture of a
 * picture: 1 x 3 x rows x columns numbers of 0 to 255, red, green, blue, both ways. */
frame_nets *frame_nets_new(const drawing *d, GError **error);
void frame_nets_free(frame_nets *n); /* NULL is fine */
/* By its path, as the step has it; NULL: there is none. Networks are run by one thread at a time. */
semantic_net *frame_nets_find(const frame_nets *n, const char *model);

#endif
