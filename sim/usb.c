#include "sim/usb.h"
#include <string.h>

enum { DEVICE = 1, CONFIGURATION = 2, STRING = 3 }; /* types of descriptors */
enum { OF_DEVICE = 0, OF_INTERFACE = 1, OF_ENDPOINT = 2 };
enum request {
	GET_STATUS = 0,
	CLEAR_FEATURE = 1,
	SET_FEATURE = 3,
	GET_DESCRIPTOR = 6,
	GET_CONFIGURATION = 8,
	SET_CONFIGURATION = 9,
	GET_INTERFACE = 10,
	SET_INTERFACE = 11,
};
#define ENDPOINT_HALT 0
#define US_ENGLISH    0x0409

static const struct usb_gadget *const gadgets[] = { &usb_sick, &usb_hokuyo, &usb_cp2102 };

const struct usb_gadget *usb_gadget_by_name(const char *name)
{
	for (gsize i = 0; i < G_N_ELEMENTS(gadgets); i++)
		if (strcmp(gadgets[i]->name, name) == 0)
			return gadgets[i];
	return NULL;
}

const struct usb_gadget *usb_gadget_of(const char *protocol)
{
	if (strcmp(protocol, "cola") == 0)
		return &usb_sick;
	return strcmp(protocol, "scip") == 0 ? &usb_hokuyo : &usb_cp2102;
}

static int device_descriptor(const struct usb_gadget *g, uint8_t *data)
{
	const uint8_t bytes[18] = { 18, DEVICE, 0x00, 0x02, g->device_class, 0, 0, 64,
		(uint8_t)g->vendor, g->vendor >> 8, (uint8_t)g->product, g->product >> 8,
		(uint8_t)g->release, g->release >> 8, g->strings[1] ? 1 : 0, g->strings[2] ? 2 : 0,
		g->strings[3] ? 3 : 0, 1 };

	memcpy(data, bytes, sizeof bytes);
	return sizeof bytes;
}

static int string_descriptor(const struct usb_gadget *g, uint8_t index, uint8_t *data)
{
	const char *text = index < G_N_ELEMENTS(g->strings) ? g->strings[index] : NULL;

	data[1] = STRING;
	if (index == 0) {
		data[0] = 4;
		data[2] = US_ENGLISH & 0xff;
		data[3] = US_ENGLISH >> 8;
		return 4;
	}
	if (!text)
		return -1;
	data[0] = (uint8_t)(2 + 2 * strlen(text));
	for (gsize i = 0; text[i]; i++) {
		data[2 + 2 * i] = (uint8_t)text[i];
		data[3 + 2 * i] = 0;
	}
	return data[0];
}

static int descriptor(const struct usb_gadget *g, uint16_t value, uint8_t *data)
{
	switch (value >> 8) {
	case DEVICE: return device_descriptor(g, data);
	case CONFIGURATION:
		if ((value & 0xff) != 0)
			return -1;
		memcpy(data, g->configuration, g->configuration_length);
		return (int)g->configuration_length;
	case STRING: return string_descriptor(g, value & 0xff, data);
	default: return -1; /* such as a qualifier, which says: full speed only */
	}
}

static bool *halt_of(const struct usb_gadget *g, struct usb_state *state, uint16_t endpoint)
{
	if (endpoint == g->in)
		return &state->in_halted;
	return endpoint == g->out ? &state->out_halted : NULL;
}

static int feature(const struct usb_gadget *g, struct usb_state *state,
	const struct usb_setup *setup, enum usb_change *ret_change)
{
	bool *halt = halt_of(g, state, setup->index);

	if ((setup->request_type & USB_RECIPIENT_MASK) != OF_ENDPOINT)
		return setup->value == 1 ? 0
					 : -1; /* to wake the host by itself, which it never does */
	if (setup->value != ENDPOINT_HALT || !halt)
		return -1;
	*halt = setup->request == SET_FEATURE;
	if (!*halt && setup->index == g->in)
		*ret_change = USB_IN_CLEARED;
	return 0;
}

static int status(const struct usb_gadget *g, struct usb_state *state,
	const struct usb_setup *setup, uint8_t *data)
{
	bool *halt = halt_of(g, state, setup->index);

	data[0] = data[1] = 0;
	if ((setup->request_type & USB_RECIPIENT_MASK) == OF_DEVICE)
		data[0] = g->configuration[7] >> 6 & 1; /* self-powered */
	else if ((setup->request_type & USB_RECIPIENT_MASK) == OF_ENDPOINT && halt)
		data[0] = *halt;
	return 2;
}

static int configure(struct usb_state *state, uint16_t value, enum usb_change *ret_change)
{
	if (value > 1)
		return -1;
	*state = (struct usb_state){ .configured = (uint8_t)value };
	if (value)
		*ret_change = USB_CONFIGURED;
	return 0;
}

int usb_standard(const struct usb_gadget *gadget, struct usb_state *state,
	const struct usb_setup *setup, uint8_t *data, enum usb_change *ret_change)
{
	*ret_change = USB_SAME;
	switch (setup->request) {
	case GET_STATUS: return status(gadget, state, setup, data);
	case CLEAR_FEATURE:
	case SET_FEATURE: return feature(gadget, state, setup, ret_change);
	case GET_DESCRIPTOR: return descriptor(gadget, setup->value, data);
	case GET_CONFIGURATION: data[0] = state->configured; return 1;
	case SET_CONFIGURATION: return configure(state, setup->value, ret_change);
	case GET_INTERFACE: data[0] = 0; return 1;
	case SET_INTERFACE:
		if (setup->value != 0)
			return -1;
		state->in_halted = state->out_halted = false;
		*ret_change = USB_CONFIGURED;
		return 0;
	default: return -1;
	}
}
