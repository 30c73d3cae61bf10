#!/bin/sh
# deps.sh PACKAGE...: installs the Debian packages that are missing, and says what it does. Does nothing, also without a
# network, when all are there.
missing=
for package; do
	case " $missing " in *" $package "*) continue ;; esac
	dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed || missing="$missing $package"
done
if [ -z "$missing" ]; then
	echo "deps: all packages are installed"
	exit 0
fi
echo "deps: installing$missing"
sudo=
if [ "$(id -u)" -ne 0 ]; then
	sudo=sudo
	command -v sudo >/dev/null || { echo "deps: not root and no sudo: install these packages by hand, then try again" >&2; exit 1; }
fi
export DEBIAN_FRONTEND=noninteractive
install() {
	# shellcheck disable=SC2086
	$sudo apt-get install --yes --quiet --no-install-recommends $missing
}
# Package lists may be missing or old: only then ask for new ones.
if ! install; then
	$sudo apt-get update --quiet && install || { echo "deps: apt-get could not install:$missing" >&2; exit 1; }
fi
