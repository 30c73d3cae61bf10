/* fingers: a touch screen of the kernel's own making (uinput), as multi-touch panels are: ten slots, positions of 0 to 4095. Reads lines: "tap X Y"
 * in shares of its sides, and "quit". Answers each with "done". */
#include <errno.h>
#include <fcntl.h>
#include <linux/uinput.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define SIDE  4095
#define SLOTS 10

static int device = -1;

static void say(int type, int code, int value)
{
	struct input_event e = {
		.type = (unsigned short)type, .code = (unsigned short)code, .value = value
	};
	if (write(device, &e, sizeof e) != sizeof e)
		perror("fingers: an event is not taken");
}

static void show(void)
{
	say(EV_SYN, SYN_REPORT, 0);
	usleep(20000);
}

static void place(int slot, int id, double x, double y)
{
	say(EV_ABS, ABS_MT_SLOT, slot);
	say(EV_ABS, ABS_MT_TRACKING_ID, id);
	say(EV_ABS, ABS_MT_POSITION_X, (int)lrint(x * SIDE));
	say(EV_ABS, ABS_MT_POSITION_Y, (int)lrint(y * SIDE));
}

static void lift(int slot)
{
	say(EV_ABS, ABS_MT_SLOT, slot);
	say(EV_ABS, ABS_MT_TRACKING_ID, -1);
}

static void tap(double x, double y)
{
	static int id;
	place(0, ++id, x, y);
	say(EV_KEY, BTN_TOUCH, 1);
	show();
	usleep(80000);
	lift(0);
	say(EV_KEY, BTN_TOUCH, 0);
	show();
}

static bool add_axis(int code, int most)
{
	struct uinput_abs_setup axis = { .code = (unsigned short)code,
		.absinfo = { .maximum = most, .resolution = code == ABS_MT_SLOT ? 0 : 20 } };
	return ioctl(device, UI_ABS_SETUP, &axis) == 0;
}

static bool plug_in(void)
{
	struct uinput_setup setup = {
		.id = { .bustype = BUS_USB, .vendor = 0x1234, .product = 0x5678 },
		.name = "pleinair test panel"
	};
	device = open("/dev/uinput", O_WRONLY | O_CLOEXEC);
	return device >= 0 && ioctl(device, UI_SET_EVBIT, EV_KEY) == 0 &&
	       ioctl(device, UI_SET_KEYBIT, BTN_TOUCH) == 0 &&
	       ioctl(device, UI_SET_EVBIT, EV_ABS) == 0 &&
	       ioctl(device, UI_SET_PROPBIT, INPUT_PROP_DIRECT) == 0 && add_axis(ABS_X, SIDE) &&
	       add_axis(ABS_Y, SIDE) && add_axis(ABS_MT_SLOT, SLOTS - 1) &&
	       add_axis(ABS_MT_TRACKING_ID, 65535) && add_axis(ABS_MT_POSITION_X, SIDE) &&
	       add_axis(ABS_MT_POSITION_Y, SIDE) && ioctl(device, UI_DEV_SETUP, &setup) == 0 &&
	       ioctl(device, UI_DEV_CREATE) == 0;
}

int main(void)
{
	char line[100];
	double x, y;
	if (!plug_in()) {
		fprintf(stderr, "fingers: no touch screen can be made: %s\n", strerror(errno));
		return 1;
	}
	puts("ready");
	fflush(stdout);
	while (fgets(line, sizeof line, stdin) && strcmp(line, "quit\n") != 0) {
		if (sscanf(line, "tap %lf %lf", &x, &y) == 2)
			tap(x, y);
		puts("done");
		fflush(stdout);
	}
	ioctl(device, UI_DEV_DESTROY);
	return 0;
}
