#include "firmware-io/gpio-lines.h"

void gpio_lines_free(gpio_lines *l)
{
	if (l)
		l->ops->free(l);
}

bool gpio_lines_set(gpio_lines *l, size_t line, bool on)
{
	return l->ops->set(l, line, on);
}

int gpio_lines_get(gpio_lines *l, size_t line)
{
	return l->ops->get(l, line);
}

gssize gpio_lines_read(gpio_lines *l, struct gpio_edge *edges, size_t room)
{
	return l->ops->read(l, edges, room);
}
