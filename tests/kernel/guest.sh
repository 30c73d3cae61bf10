#!/bin/sh
# Runs in QEMU, as root, once systemd has started both daemons (run.sh). Prints TAP. Every program that is started here takes a tenth of
# a second and more: it asks sparingly.
export LC_ALL=C.UTF-8
sites=/var/lib/pleinair/sites
n=0
result() { # STATUS WORDS: 0 is good
	n=$((n + 1))
	if [ "$1" -eq 0 ]; then echo "ok $n - $2"; else echo "not ok $n - $2"; fi
}
comment() { printf '%s\n' "$*" | sed 's/^/# /'; }
shows() { systemctl show --value -p "$2" "pleinair-$1.service"; }
as() { # USER COMMAND...
	user=$1
	shift
	setpriv --reuid="$user" --regid="$user" --init-groups "$@"
}
name_of() { if [ "$1" = acquired ]; then echo Acquisition1; else echo Jobs1; fi; }
call() { # DAEMON METHOD ARGUMENTS...
	name=$(name_of "$1")
	shift
	busctl --timeout=100 call "org.pleinair.$name" "/org/pleinair/$name" "org.pleinair.$name" "$@"
}
property() { busctl get-property org.pleinair.Acquisition1 /org/pleinair/Acquisition1 org.pleinair.Acquisition1 "$1"; }
uptime_ms() { awk '{ printf "%d", $1 * 1000 }' /proc/uptime; }
wait_for() { # SECONDS COMMAND...
	left=$1
	shift
	until "$@"; do
		[ "$left" -gt 0 ] || return 1
		left=$((left - 1))
		sleep 1
	done
}
state_is() { property State | grep -q "\"$1\""; }

runs_as() { # DAEMON USER
	pid=$(shows "$1" MainPID)
	[ "$(shows "$1" ActiveState)" = active ] && [ "$pid" -gt 1 ]
	result $? "pleinair-$1 is active, $(($(shows "$1" ActiveEnterTimestampMonotonic) / 1000)) ms after the kernel began"
	comment "$(grep -E '^(Uid|Gid|CapBnd|NoNewPrivs|Seccomp):' "/proc/$pid/status" | tr '\t\n' ' ;')"
	[ "$(stat -c %U:%G "/proc/$pid")" = "$2:pleinair" ] && grep -q 'CapBnd:.0*$' "/proc/$pid/status" &&
		grep -q 'NoNewPrivs:.1' "/proc/$pid/status" && grep -q 'Seccomp:.2' "/proc/$pid/status"
	result $? "pleinair-$1 runs as $2:pleinair, without capabilities, behind its filter of system calls"
}

refuses() { # DAEMON METHOD ARGUMENTS...
	call "$@" > /dev/null
	result $? "pleinair-$1 answers root"
	name=$(name_of "$1")
	daemon=$1
	shift
	as surveyor busctl --timeout=100 call "org.pleinair.$name" "/org/pleinair/$name" "org.pleinair.$name" "$@" > /dev/null
	result $? "pleinair-$daemon answers a member of the group pleinair"
	said=$(as passerby busctl --timeout=100 call "org.pleinair.$name" "/org/pleinair/$name" "org.pleinair.$name" "$@" 2>&1) || said="refused: $said"
	case $said in refused:*enied* | refused:*rejected* | refused:*not\ allowed*) true ;; *) false ;; esac
	result $? "pleinair-$daemon does not answer anyone else"
	comment "$said"
	said=$(as surveyor busctl --timeout=100 call org.freedesktop.DBus /org/freedesktop/DBus org.freedesktop.DBus RequestName su "org.pleinair.$name" 4 2>&1)
	case $said in *"not allowed to own"* | *enied*) true ;; *) false ;; esac
	result $? "a member of the group may not be org.pleinair.$name"
}

is_fed() { # DAEMON STAMP
	[ "$(shows "$1" WatchdogTimestampMonotonic)" -gt "$2" ]
}

comes_back() { # DAEMON
	pid=$(shows "$1" MainPID)
	killed=$(uptime_ms)
	kill -KILL "$pid"
	back() {
		[ "$(shows "$1" ActiveState)" = active ] && [ "$(shows "$1" MainPID)" -ne "$pid" ]
	}
	wait_for 30 back "$1"
	lives=$?
	begun=$(($(shows "$1" ExecMainStartTimestampMonotonic) / 1000 - killed))
	ready=$(($(shows "$1" ActiveEnterTimestampMonotonic) / 1000 - killed))
	# Linking a program takes seconds in QEMU: what systemd takes is held to the three seconds, the rest only told.
	[ $lives -eq 0 ] && [ $begun -lt 3000 ] && [ $ready -lt 20000 ]
	result $? "pleinair-$1, killed, is started again after $begun ms and ready after $ready ms"
}

comment "$(uname -r), systemd $(systemctl --version | sed -n '1s/systemd \([0-9]*\).*/\1/p'); the test begins $(uptime_ms) ms after the kernel"
runs_as acquired pleinair-acquired
runs_as jobsd pleinair-jobs
# The stage's thread asks for SCHED_FIFO, and its pages are to stay.
limits=$(grep -E 'realtime priority|locked memory' "/proc/$(shows acquired MainPID)/limits" | tr -s ' ')
printf '%s' "$limits" | grep -q 'realtime priority 90 90'
result $? "pleinair-acquired may run its stage's thread in real time"
comment "$limits"
fed_acquired=$(shows acquired WatchdogTimestampMonotonic)
fed_jobsd=$(shows jobsd WatchdogTimestampMonotonic)
refuses acquired ListPresets
refuses jobsd ListSites s ""
[ "$(stat -c %a:%U:%G $sites)" = 2770:root:pleinair ]
result $? "the folder of sites is the group's"
as passerby ls $sites > /dev/null 2>&1
[ $? -ne 0 ]
result $? "and nobody else's"

# A scan, which nothing but the scanner's own end may end.
said=$(as surveyor busctl --timeout=100 call org.pleinair.Acquisition1 /org/pleinair/Acquisition1 org.pleinair.Acquisition1 Start 'ssa{sv}' $sites/oak draft 0 2>&1)
result $? "a member of the group starts a scan of the simulated head"
comment "$said"
wait_for 60 state_is scanning
result $? "it scans"
[ "$(stat -c %a:%U:%G $sites/oak $sites/oak/scans | sort -u)" = 2770:pleinair-acquired:pleinair ]
result $? "the site is pleinair-acquired's and the group's"
comment "$(find $sites | head -20 | xargs stat -c '%a %U:%G %n')"
comes_back jobsd
state_is scanning
result $? "the scan goes on while jobsd is killed and started again"
call jobsd ListSites s "" | grep -q "$sites/oak"
result $? "jobsd lists the site"
printf 'ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\nproperty float z\nend_header\n' > $sites/wall.ply
awk 'BEGIN { for (i = 0; i < 400; i++) print i % 20 * 0.05, 2, int(i / 20) * 0.05 }' >> $sites/wall.ply
is_fed acquired "$fed_acquired" || wait_for 30 is_fed acquired "$fed_acquired"
result $? "the watchdog of pleinair-acquired is fed, during a scan too"

# What SIGTERM does to a scan: it is kept.
systemctl restart pleinair-acquired.service
result $? "systemd stops and starts it during a scan"
comment "$(find $sites/oak/scans -type f -size +0 | xargs stat -c '%s %n')"
[ -s $sites/oak/scans/.0001.partial/raw.rec ]
result $? "what was scanned is kept"
said=$(as surveyor busctl --timeout=100 call org.pleinair.Acquisition1 /org/pleinair/Acquisition1 org.pleinair.Acquisition1 Resume sb $sites/oak false 2>&1)
result $? "and is gone on with"
comment "$said"
comes_back acquired
# Not while it looks at the head.
discards() { call acquired Discard s $sites/oak > /dev/null; }
wait_for 60 discards
result $? "a scan whose program was killed can be removed"

# Work of jobsd in a site that acquired made.
said=$(as surveyor busctl --timeout=100 call org.pleinair.Jobs1 /org/pleinair/Jobs1 org.pleinair.Jobs1 Start 'ssa{sv}' import $sites/oak 1 arguments as 1 $sites/wall.ply 2>&1)
result $? "a member of the group starts a job"
comment "$said"
job=$(printf '%s' "$said" | sed -n 's/^o "\(.*\)"$/\1/p')
job_ended() {
	busctl get-property org.pleinair.Jobs1 "$job" org.pleinair.Jobs1.Job State | grep -qE '"(done|failed|cancelled)"'
}
wait_for 60 job_ended
comment "$(busctl get-property org.pleinair.Jobs1 "$job" org.pleinair.Jobs1.Job State Error)"
[ "$(stat -c %a:%U:%G $sites/oak/scans/0*)" = 2770:pleinair-jobs:pleinair ]
result $? "a job writes into the site that the scanner made, for the group"
is_fed jobsd "$fed_jobsd" || wait_for 30 is_fed jobsd "$fed_jobsd"
result $? "the watchdog of pleinair-jobsd is fed"

listening=$(ss -Hlntu)
[ -z "$listening" ]
result $? "nothing listens on a network"
comment "$listening"
[ "$(shows acquired NRestarts)" -eq 1 ] && [ "$(shows jobsd NRestarts)" -eq 1 ]
result $? "none of them ended by itself"
comment "$(journalctl -b --no-pager -o short-monotonic -u 'pleinair-acquired' -u 'pleinair-jobsd' | tail -40)"
comment "the test ends $(uptime_ms) ms after the kernel began"
echo "1..$n"
