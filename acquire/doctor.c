#include "acquire/doctor.h"
#include "acquire/preset.h"
#include "firmware-io/files.h"
#include <errno.h>
#include <glib/gi18n.h>
#include <glib/gstdio.h>
#include <grp.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/sysinfo.h>
#include <sys/timex.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

#define SITES         "/var/lib/pleinair/sites"
#define MEGABYTE      1000000.0
#define PROBE_BYTES   (4u << 20)
#define PROBE_NAME    "pleinair-doctor.probe"
#define SLOW_DISK_MBS 4.0 /* a fine scan by a fast lidar, with its photos, writes half of that */
#define FEW_SCANS     10
#define LITTLE_MEMORY (1000 * MEGABYTE)
#define WAKES         200
#define WAKE_NS       1000000
#define LATE_NS       1000000 /* a step at ten degrees a second takes three times as long */

const char *const finding_state_names[] = { "good", "note", "bad" };

void finding_free(struct finding *f)
{
	if (!f)
		return;
	g_free(f->sentence);
	g_free(f->advice);
	g_free(f);
}

void doctor_say(GPtrArray *findings, enum finding_state state, const char *subject,
	const char *advice, const char *format, ...)
{
	struct finding *f = g_new0(struct finding, 1);
	va_list arguments;
	va_start(arguments, format);
	*f = (struct finding){ state, subject, g_strdup_vprintf(format, arguments),
		g_strdup(advice) };
	va_end(arguments);
	g_ptr_array_add(findings, f);
}

/* ---- space ---- */

/* Of a fine scan by a lidar of the usual kind. */
static double fine_scan_bytes(void)
{
	struct lidar_identity lidar = {
		.angle_step_rad = 270 * G_PI / 180 / 810, .beams = 811, .scan_rate_hz = 15
	};
	struct calibration c = { .stage = { .steps_per_turn = 11886 },
		.has_camera = true,
		.camera = { .width = 720, .height = 1280 } };
	return (double)preset_predict(preset_find("fine"), false, driver_find("cola"), &lidar, &c)
		.bytes;
}

/* Bytes a second that reach the disk; below 0: it cannot be written. */
static double disk_speed(const char *folder, GError **error)
{
	g_autofree char *path = g_build_filename(folder, PROBE_NAME, NULL),
			*bytes = g_malloc0(PROBE_BYTES);
	int64_t begun_us = g_get_monotonic_time();
	bool good = files_write(path, bytes, PROBE_BYTES, error);
	double seconds = (double)MAX(g_get_monotonic_time() - begun_us, 1) * 1e-6;
	g_unlink(path);
	return good ? PROBE_BYTES / seconds : -1;
}

static void look_at_writing(GPtrArray *findings, const char *folder)
{
	g_autoptr(GError) error = NULL;
	double speed = disk_speed(folder, &error);
	if (speed < 0)
		doctor_say(findings, FINDING_BAD, "space",
			N_("Choose another folder, or another disk; the appliance's folder is for "
			   "members of the group 'pleinair'."),
			"%s cannot be written: %s", folder, error->message);
	else if (speed < SLOW_DISK_MBS * MEGABYTE)
		doctor_say(findings, FINDING_BAD, "space", N_("Scan onto a faster disk."),
			"%s takes only %.1f MB a second", folder, speed / MEGABYTE);
	else
		doctor_say(findings, FINDING_GOOD, "space", NULL,
			"%s can be written, at %.0f MB a second", folder, speed / MEGABYTE);
}

static void look_at_space(GPtrArray *findings, const char *folder)
{
	struct statvfs s;
	if (statvfs(folder, &s) < 0) {
		doctor_say(findings, FINDING_BAD, "space", N_("Make it, or name another folder."),
			"%s cannot be looked at: %s", folder, g_strerror(errno));
		return;
	}
	double bytes = (double)s.f_bavail * s.f_frsize, scans = bytes / fine_scan_bytes();
	const char *advice =
		N_("Copy finished sites to a drive and remove them here ('pleinair copy').");
	if (s.f_flag & ST_RDONLY)
		doctor_say(findings, FINDING_BAD, "space",
			N_("Choose another folder, or another disk."), "%s can only be read",
			folder);
	else if (scans < 1)
		doctor_say(findings, FINDING_BAD, "space", advice,
			"%s has %.0f MB left: no fine scan fits", folder, bytes / MEGABYTE);
	else
		doctor_say(findings, scans < FEW_SCANS ? FINDING_NOTE : FINDING_GOOD, "space",
			scans < FEW_SCANS ? advice : NULL,
			"%s has %.1f GB left, for some %.0f fine scans", folder,
			bytes / MEGABYTE / 1000, scans);
	if (s.f_files && s.f_favail < 1000)
		doctor_say(findings, FINDING_BAD, "space", advice,
			"%s has room for %lu more files only", folder, (unsigned long)s.f_favail);
	if (!(s.f_flag & ST_RDONLY))
		look_at_writing(findings, folder);
}

static void look_at_memory(GPtrArray *findings)
{
	g_autofree char *text = NULL;
	const char *at = g_file_get_contents("/proc/meminfo", &text, NULL, NULL)
				 ? strstr(text, "MemAvailable:")
				 : NULL;
	double bytes = at ? g_ascii_strtod(at + strlen("MemAvailable:"), NULL) * 1024 : 0;
	if (at)
		doctor_say(findings, bytes < LITTLE_MEMORY ? FINDING_NOTE : FINDING_GOOD, "memory",
			bytes < LITTLE_MEMORY ? N_("Scanning works; close other programs before a "
						   "site is processed.")
					      : NULL,
			"%.1f GB of memory are free", bytes / 1e9);
}

/* ---- clocks ---- */

static void look_at_wall_clock(GPtrArray *findings)
{
	struct timex t = { 0 };
	bool in_step = adjtimex(&t) != TIME_ERROR && !(t.status & STA_UNSYNC);
	g_autoptr(GDateTime) now = g_date_time_new_now_local();
	g_autofree char *text = g_date_time_format(now, "%F %R");
	if (g_date_time_get_year(now) < 2025)
		doctor_say(findings, FINDING_BAD, "clock",
			N_("Set it: timedatectl set-time 'YYYY-MM-DD HH:MM'."),
			"the clock says %s: scans would be dated so", text);
	else
		doctor_say(findings, in_step ? FINDING_GOOD : FINDING_NOTE, "clock",
			in_step ? NULL
				: N_("See that the date is right; scans are placed by another "
				     "clock, and not harmed."),
			in_step ? "the clock says %s, and is kept in step"
				: "the clock says %s, and nothing keeps it in step",
			text);
}

static void look_at_clock_source(GPtrArray *findings)
{
	static const char *const slow[] = { "jiffies", "pit", "refined-jiffies", NULL };
	g_autofree char *source = NULL;
	if (!g_file_get_contents("/sys/devices/system/clocksource/clocksource0/current_clocksource",
		    &source, NULL, NULL))
		return;
	g_strstrip(source);
	bool coarse = g_strv_contains(slow, source);
	doctor_say(findings, coarse ? FINDING_BAD : FINDING_GOOD, "clock",
		coarse ? N_("Boot without clocksource=, or with a newer kernel: beams are placed "
			    "by this clock.")
		       : NULL,
		"beams are timed by the kernel's %s", source);
}

static int64_t now_ns(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return t.tv_sec * INT64_C(1000000000) + t.tv_nsec;
}

/* How much later than asked for a thread wakes, at worst. */
static int64_t worst_wake_ns(void)
{
	int64_t worst = 0, due = now_ns();
	for (int i = 0; i < WAKES; i++) {
		due += WAKE_NS;
		struct timespec t = { due / 1000000000, due % 1000000000 };
		clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &t, NULL);
		worst = MAX(worst, now_ns() - due);
		due = MAX(due, now_ns());
	}
	return worst;
}

static void look_at_wakes(GPtrArray *findings)
{
	int64_t worst = worst_wake_ns();
	doctor_say(findings, worst > LATE_NS ? FINDING_NOTE : FINDING_GOOD, "clock",
		worst > LATE_NS ? N_("Close other programs while scanning. Late steps make the "
				     "head jerk, and are told of, but no beam is placed wrongly.")
				: NULL,
		"a thread that waits for a millisecond wakes %.2f ms late at worst",
		(double)worst * 1e-6);
}

/* ---- rights, kernel ---- */

static void look_at_priority(GPtrArray *findings)
{
	struct rlimit limit = { 0 };
	getrlimit(RLIMIT_RTPRIO, &limit);
	bool may = geteuid() == 0 || limit.rlim_cur > 0;
	doctor_say(findings, may ? FINDING_GOOD : FINDING_NOTE, "rights",
		may ? NULL
		    : N_("Scan through the service (systemctl start pleinair-acquired), which may, "
			 "or raise rtprio in /etc/security/limits.d."),
		may ? "steps of the stage can go before all else (real-time priority)"
		    : "you may not let steps of the stage go before all else (real-time priority)");
}

static bool is_member(const char *name)
{
	struct group *g = getgrnam(name);
	gid_t all[256];
	int n = getgroups(G_N_ELEMENTS(all), all);
	for (int i = 0; g && i < n; i++)
		if (all[i] == g->gr_gid)
			return true;
	return g && getegid() == g->gr_gid;
}

static void look_at_groups(GPtrArray *findings)
{
	if (!getgrnam("pleinair") || geteuid() == 0)
		return;
	bool member = is_member("pleinair");
	doctor_say(findings, member ? FINDING_GOOD : FINDING_BAD, "rights",
		member ? NULL : N_("Become one: sudo adduser $USER pleinair, then log in again."),
		member ? "you are in the group 'pleinair', which may use this appliance"
		       : "you are not in the group 'pleinair': the appliance's service will not "
			 "answer you");
}

static void look_at_kernel(GPtrArray *findings)
{
	static const struct {
		const char *path, *what, *advice;
	} parts[] = {
		{ "/dev/bus/usb", "USB devices",
			N_("Without them no SICK TiM: is usbcore loaded, and /dev/bus/usb "
			   "there?") },
		{ "/sys/class/video4linux", "cameras", N_("modprobe videodev") },
		{ "/sys/bus/gpio", "pins",
			N_("Its kernel was built without GPIO (Debian's cloud kernel is): install "
			   "linux-image-amd64.") },
	};
	struct utsname u;
	uname(&u);
	double version = g_ascii_strtod(u.release, NULL);
	int major = (int)version;
	if (major < 5)
		doctor_say(findings, FINDING_BAD, "kernel", N_("Use Linux 5.10 or later."),
			"Linux %s is too old: edges of pins are not timed as they should",
			u.release);
	else
		doctor_say(findings, FINDING_GOOD, "kernel", NULL, "Linux %s", u.release);
	for (size_t i = 0; i < G_N_ELEMENTS(parts); i++)
		if (!g_file_test(parts[i].path, G_FILE_TEST_EXISTS))
			doctor_say(findings, FINDING_NOTE, "kernel", parts[i].advice,
				"the kernel shows no %s", parts[i].what);
}

GPtrArray *doctor_look(const struct doctor_options *options)
{
	GPtrArray *findings = g_ptr_array_new_with_free_func((GDestroyNotify)finding_free);
	const char *folder = options->folder                          ? options->folder
			     : g_file_test(SITES, G_FILE_TEST_IS_DIR) ? SITES
								      : ".";
	doctor_look_at_devices(findings, options);
	look_at_groups(findings);
	look_at_priority(findings);
	look_at_wall_clock(findings);
	look_at_clock_source(findings);
	look_at_wakes(findings);
	look_at_space(findings, folder);
	look_at_memory(findings);
	look_at_kernel(findings);
	return findings;
}
