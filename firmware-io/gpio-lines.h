#ifndef FIRMWARE_IO_GPIO_LINES_H
#define FIRMWARE_IO_GPIO_LINES_H
/* Some lines of one GPIO chip, through libgpiod: gpio-lines-1.c for its first API (Debian 12), gpio-lines-2.c for its second (Debian 13). Levels
 * are logical: an active-low line is on when it is low.
 *
 * One owner at a time; nothing blocks. */
#include <glib.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct gpio_line_desc {
	const char *line; /* its name, or its number on the chip */
	bool output;      /* off to begin with; else an input, whose edges are told */
	bool active_low;
};

struct gpio_edge {
	size_t line; /* of those that were asked for */
	bool on;
	int64_t time_ns; /* CLOCK_MONOTONIC, by the kernel */
};

typedef struct gpio_lines gpio_lines;
struct gpio_lines_ops {
	bool (*set)(gpio_lines *l, size_t line, bool on);
	int (*get)(gpio_lines *l, size_t line);
	gssize (*read)(gpio_lines *l, struct gpio_edge *edges, size_t room);
	void (*free)(gpio_lines *l);
};
/* The head of every backend's own struct. */
struct gpio_lines {
	const struct gpio_lines_ops *ops;
	int fd; /* readable while edges wait */
};

/* chip: "gpiochip0", its path, or its label. Fails, in words, where the chip or a line is not there, is somebody else's, or may not be had. */
gpio_lines *gpio_lines_open(
	const char *chip, const struct gpio_line_desc *lines, size_t count, GError **error);
void gpio_lines_free(gpio_lines *l); /* NULL is fine */
G_DEFINE_AUTOPTR_CLEANUP_FUNC(gpio_lines, gpio_lines_free)

/* False: the chip is gone. */
bool gpio_lines_set(gpio_lines *l, size_t line, bool on);
/* 1 on, 0 off, -1 the chip is gone. */
int gpio_lines_get(gpio_lines *l, size_t line);
/* Edges since the last call, of each line in order; 0: none; -1: the chip is gone. The kernel keeps sixteen of a line, and drops the oldest
 * beyond: whoever counts edges must read sooner, and compare levels now and then. */
gssize gpio_lines_read(gpio_lines *l, struct gpio_edge *edges, size_t room);

#endif
