#ifndef PROCESS_ONNX_CHECK_H
#define PROCESS_ONNX_CHECK_H
/* Whether a file is an ONNX model as a whole (onnx.proto of ONNX 1.12): protobuf's fields one after the other down to the graph
 * and its nodes, weights as many as their sizes say, inputs that something puts out. OpenCV's own reader says on stderr that a
 * file is cut off, reads beyond the weights that are there, and falls over inputs that nothing puts out. What the layers mean is
 * left to it. */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

bool onnx_check(const uint8_t *bytes, size_t length);

#endif
