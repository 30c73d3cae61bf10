#!/bin/sh
# check-units.sh BUILD: installs into a folder of its own, and lets the tools of systemd and the bus read what lies there.
build=$1
status=0
root=$PWD/$build/units
units=$root/usr/lib/systemd/system
bad() {
	printf 'units: %s\n' "$*" >&2
	status=1
}

rm -rf "$root"
make --no-print-directory install BUILD="$build" DESTDIR="$root" PREFIX=/usr > /dev/null || exit 1
# Once more, and over what is there: a machine's own settings stay.
echo '#kept' >> "$root/etc/pleinair.conf"
make --no-print-directory install BUILD="$build" DESTDIR="$root" PREFIX=/usr > /dev/null || exit 1
grep -q '^#kept$' "$root/etc/pleinair.conf" || bad "a second make install replaced /etc/pleinair.conf"

# Policies: well-formed, each for a name that something on the bus can be started for, by a user that is made.
for policy in "$root"/usr/share/dbus-1/system.d/*.conf; do
	name=$(basename "$policy" .conf)
	user=$(sed -n 's/.*<policy user="\(pleinair-[a-z]*\)">.*/\1/p' "$policy")
	activation=$root/usr/share/dbus-1/system-services/$name.service
	unit=$units/$(sed -n 's/^SystemdService=//p' "$activation")
	! command -v xmllint > /dev/null || xmllint --noout --nonet --nowarning "$policy" 2>&1 || bad "$policy is not well-formed"
	grep -q "^User=$user\$" "$unit" || bad "$name: policy, activation file and unit are not of the same user"
	grep -q "^u $user " "$root/usr/lib/sysusers.d/pleinair.conf" || bad "$user: sysusers does not make this user"
done
if command -v systemd-sysusers > /dev/null; then
	said=$(systemd-sysusers --root="$root" 2>&1) || bad "systemd-sysusers fails"
	printf '%s\n' "$said" | grep -v '^Creating' | grep . && bad "systemd-sysusers has something to say"
	grep -q '^pleinair:.*pleinair-acquired' "$root/etc/group" || bad "sysusers: the scanner's user is not in the group"
fi
# Rules for devices: each line compares and sets, in keys that udev has.
awk '!/^#/ && NF' "$root/usr/lib/udev/rules.d/70-pleinair.rules" | tr ',' '\n' | sed 's/^ *//' |
	grep -vE '^(ACTION|SUBSYSTEM|KERNEL|ATTRS?\{[A-Za-z/]+\}|ENV\{[A-Z_]+\}|GROUP|MODE|TAG|SYMLINK|LABEL|GOTO)(==|!=|\+?=)"[^"]*"$' &&
	bad "a rule for udev has another form"

# The screen as it was turned on itself: for all connectors, behind what the machine's own file says.
mkdir -p "$root/drm/card0-HDMI-A-1" "$root/drm/card1-eDP-1"
printf '[screen]\nasleep_after_s=60\nturned=rotate-90\n\n[other]\nturned=rotate-180\n' > "$root/turned.conf"
turned=$("$root/usr/lib/pleinair/kiosk-screen" --print "$root/etc/pleinair/weston.ini" "$root/turned.conf" "$root/drm" | grep -v '^#' | tail -7)
[ "$turned" = "$(printf '[output]\nname=HDMI-A-1\ntransform=rotate-90\n\n[output]\nname=eDP-1\ntransform=rotate-90')" ] ||
	bad "kiosk-screen: a turned screen gives: $turned"
printf '[screen]\nturned=$(reboot)\n' > "$root/turned.conf"
"$root/usr/lib/pleinair/kiosk-screen" --print "$root/etc/pleinair/weston.ini" "$root/turned.conf" "$root/drm" |
	cmp -s - "$root/etc/pleinair/weston.ini" || bad "kiosk-screen: what is no way to turn a screen is taken for one"

if ! command -v systemd-analyze > /dev/null; then
	[ $status -eq 0 ] && echo "units: SKIP verify and security: systemd-analyze is not installed"
	exit $status
fi
# The programs are where they were installed to, not in /usr/bin.
mkdir "$root/verify"
for unit in "$units"/*.service; do
	sed "s,^\(ExecStart=\)/usr/\(bin\|lib\)/pleinair,\1$root/usr/\2/pleinair," "$unit" > "$root/verify/$(basename "$unit")"
done
said=$(SYSTEMD_UNIT_PATH=$root/verify: systemd-analyze --man=no verify "$root"/verify/*.service 2>&1) || bad "systemd-analyze verify fails"
# What it says of units of others is not ours.
printf '%s\n' "$said" | grep -i pleinair && bad "systemd-analyze verify has something to say"
for daemon in acquired jobsd; do
	said=$(systemd-analyze --no-pager security --offline=true --threshold=15 "$root/verify/pleinair-$daemon.service") ||
		bad "pleinair-$daemon.service is open to more than 1.5: $said"
	scores="$scores, pleinair-$daemon $(printf '%s\n' "$said" | sed -n 's/.*: \([0-9.]* [A-Z]*\).*/\1/p' | tail -1)"
done
[ $status -eq 0 ] && echo "units: systemd accepts them; exposure of at most 1.5$scores"
exit $status
