#!/bin/sh
# Data and includes run firmware-io -> acquire -> process -> render: a folder includes itself and what stands left of it. The
# simulator includes only itself, and of it only the link's header is known outside.
status=0
check() {
	folder=$1
	allowed=$2
	bad=$(grep -nE '^#include "' "$folder"/*.[ch] "$folder"/*.cpp 2>/dev/null | grep -vE "#include \"($allowed)" || true)
	if [ -n "$bad" ]; then
		printf '%s\n' "$bad" | sed "s|^|layers: $folder may not include: |" >&2
		status=1
	fi
}
check sim 'sim/'
check firmware-io 'firmware-io/|sim/link\.h"'
check acquire 'acquire/|firmware-io/'
check process 'process/|acquire/|firmware-io/'
check render 'render/[^/]*"|process/|acquire/|firmware-io/'
check render/kiosk 'render/|process/|acquire/|firmware-io/'
# GTK is the kiosk's alone.
toolkit=$(grep -lE '#include <(gtk|gdk)' -r sim firmware-io acquire process render 2>/dev/null | grep -v '^render/kiosk/' || true)
if [ -n "$toolkit" ]; then
	echo "layers: GTK belongs in render/kiosk: $toolkit" >&2
	status=1
fi
# C++ libraries are named only behind their bridges.
bridges=$(grep -lE '#include <(pcl|opencv2)/' -r sim firmware-io acquire process render 2>/dev/null | grep -vE '_(pcl|cv)\.[ch]pp$' || true)
if [ -n "$bridges" ]; then
	echo "layers: PCL and OpenCV belong in *_pcl.[ch]pp and *_cv.[ch]pp: $bridges" >&2
	status=1
fi
[ $status -eq 0 ] && echo "layers: every folder includes only itself and what stands left of it"
exit $status
