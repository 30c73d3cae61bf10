#!/bin/sh
# install.sh DESTDIR PREFIX SYSCONFDIR FILE:PATH...: puts the appliance's files where they belong. What they say of /usr/bin,
# /usr/lib/pleinair and /etc/pleinair becomes what it is here. Files of SYSCONFDIR that are there already are somebody's, and stay.
set -e
destdir=$1 prefix=$2 sysconfdir=$3
shift 3
for pair; do
	from=systemd/${pair%%:*} to=$destdir${pair#*:}
	case ${pair#*:} in
	"$sysconfdir"/dbus-1/*) ;;
	"$sysconfdir"/*) [ ! -e "$to" ] || { echo "install: $to is there already, and stays"; continue; } ;;
	esac
	mode=644
	[ ! -x "$from" ] || mode=755
	install -d "$(dirname "$to")"
	sed -e "s|/usr/bin/pleinair|$prefix/bin/pleinair|g" -e "s|/usr/lib/pleinair|$prefix/lib/pleinair|g" \
		-e "s|/etc/pleinair/|$sysconfdir/pleinair/|g" "$from" > "$to"
	chmod $mode "$to"
done
