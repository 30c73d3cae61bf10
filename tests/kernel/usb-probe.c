/* usb-probe SECONDS: asks the TiM on this machine's USB by libusb who it is, then reads its telegrams for so long by queued transfers and says
 * how many came, how many the scan counter misses, and how fast. Clears a halted endpoint. Exit status 0: nothing was lost. */
#include <glib.h>
#include <libusb-1.0/libusb.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define VENDOR  0x19a2
#define PRODUCT 0x5001
#define QUEUED  4
#define SIZE    65536

struct probe {
	libusb_device_handle *device;
	GString *text;
	unsigned telegrams, missing, transfers, halts, flying;
	long counter;
	bool stop, gone;
};

static double now_s(void)
{
	struct timespec now;

	clock_gettime(CLOCK_MONOTONIC, &now);
	return now.tv_sec + now.tv_nsec * 1e-9;
}

static bool say(struct probe *p, const char *command)
{
	g_autofree char *frame = g_strdup_printf("\x02%s\x03", command);
	int sent;

	return libusb_bulk_transfer(p->device, 0x02, (unsigned char *)frame, (int)strlen(frame),
		       &sent, 1000) == 0;
}

static bool ask(struct probe *p, const char *command)
{
	static unsigned char answer[SIZE];
	int got = 0;
	double begun = now_s();
	int done = say(p, command)
			   ? libusb_bulk_transfer(p->device, 0x81, answer, SIZE - 1, &got, 2000)
			   : -1;

	answer[got] = '\0';
	printf("# %s: %s%.70s, %.1f ms\n", command, done == 0 ? "" : libusb_error_name(done),
		got > 0 ? (char *)answer + 1 : "", (now_s() - begun) * 1e3);
	return done == 0;
}

static void take_telegram(struct probe *p, const char *telegram)
{
	g_auto(GStrv) words = g_strsplit(telegram, " ", 10);

	if (g_strv_length(words) < 10 || strcmp(words[1], "LMDscandata") != 0)
		return;
	long counter = strtol(words[8], NULL, 16);

	if (p->telegrams++ > 0)
		p->missing += (unsigned)((counter - p->counter - 1) & 0xffff);
	p->counter = counter;
}

static void on_transfer(struct libusb_transfer *transfer)
{
	struct probe *p = transfer->user_data;
	char *end;

	p->transfers++;
	if (transfer->actual_length > 0)
		g_string_append_len(p->text, (char *)transfer->buffer, transfer->actual_length);
	while ((end = memchr(p->text->str, 3, p->text->len))) {
		*end = '\0';
		take_telegram(p, p->text->str + 1);
		g_string_erase(p->text, 0, end + 1 - p->text->str);
	}
	if (transfer->status == LIBUSB_TRANSFER_STALL) {
		p->halts++;
	} else if (transfer->status == LIBUSB_TRANSFER_NO_DEVICE ||
		   transfer->status == LIBUSB_TRANSFER_ERROR) {
		p->gone = true;
	} else if (!p->stop && !p->gone && libusb_submit_transfer(transfer) == 0) {
		return;
	}
	p->flying--;
}

static bool stream(struct probe *p, double seconds)
{
	struct libusb_transfer *transfers[QUEUED];
	double begun = now_s(), cpu = (double)clock() / CLOCKS_PER_SEC;
	struct timeval wait = { 0, 100000 };

	for (int i = 0; i < QUEUED; i++) {
		transfers[i] = libusb_alloc_transfer(0);
		libusb_fill_bulk_transfer(
			transfers[i], p->device, 0x81, g_malloc(SIZE), SIZE, on_transfer, p, 0);
	}
	while (!p->gone && now_s() - begun < seconds) {
		if (p->flying == 0 && p->halts > 0)
			libusb_clear_halt(p->device, 0x81);
		for (int i = 0; i < QUEUED && p->flying < QUEUED; i++)
			p->flying += libusb_submit_transfer(transfers[i]) == 0;
		libusb_handle_events_timeout(NULL, &wait);
	}
	p->stop = true;
	for (int i = 0; i < QUEUED; i++)
		libusb_cancel_transfer(transfers[i]);
	while (p->flying > 0)
		libusb_handle_events_timeout(NULL, &wait);
	printf("# %u telegrams in %.1f s, %u missing, %u transfers, %u halts%s, %.0f ms of CPU\n",
		p->telegrams, now_s() - begun, p->missing, p->transfers, p->halts,
		p->gone ? ", unplugged" : "", ((double)clock() / CLOCKS_PER_SEC - cpu) * 1e3);
	return p->telegrams > 0 && p->missing == 0 && !p->gone;
}

int main(int argc, char **argv)
{
	struct probe p = { .text = g_string_new(NULL) };
	double seconds = argc > 1 ? atof(argv[1]) : 2;

	libusb_init(NULL);
	p.device = libusb_open_device_with_vid_pid(NULL, VENDOR, PRODUCT);
	if (!p.device || libusb_claim_interface(p.device, 0) != 0) {
		printf("# no device %04x:%04x that may be opened\n", VENDOR, PRODUCT);
		return 1;
	}
	if (!ask(&p, "sRN DeviceIdent") || !ask(&p, "sEN LMDscandata 1"))
		return 1;
	bool good = stream(&p, seconds);

	say(&p, "sEN LMDscandata 0");
	libusb_release_interface(p.device, 0);
	libusb_close(p.device);
	libusb_exit(NULL);
	return good ? 0 : 1;
}
