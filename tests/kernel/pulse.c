/* pulse CHIP COUNT LEVEL RATE: so many pulses of the line "step" at an even pace, DIR at LEVEL and ENABLE up, as a driver of steppers gives them. */
#include <gpiod.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

int main(int argc, char **argv)
{
	struct gpiod_chip *chip = argc == 5 ? gpiod_chip_open_lookup(argv[1]) : NULL;

	if (!chip)
		return 1;
	struct gpiod_line *step = gpiod_chip_find_line(chip, "step"),
			  *dir = gpiod_chip_find_line(chip, "dir"),
			  *enable = gpiod_chip_find_line(chip, "enable");
	double period_ns = 1e9 / atof(argv[4]);
	long count = atol(argv[2]);
	struct timespec begun, at;

	if (!step || !dir || !enable || gpiod_line_request_output(enable, "pulse", 1) ||
		gpiod_line_request_output(dir, "pulse", atoi(argv[3])) ||
		gpiod_line_request_output(step, "pulse", 0))
		return 1;
	clock_gettime(CLOCK_MONOTONIC, &begun);
	for (long i = 1; i <= count; i++) {
		long long due_ns = begun.tv_nsec + (long long)((double)i * period_ns);

		at = (struct timespec){ begun.tv_sec + due_ns / 1000000000, due_ns % 1000000000 };
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &at, NULL);
		gpiod_line_set_value(step, 1);
		gpiod_line_set_value(step, 0);
	}
	gpiod_chip_close(chip);
	return 0;
}
