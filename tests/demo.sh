#!/bin/sh
# demo.sh BIN SITE: four fine scans of the simulated courtyard, and a page that shows them.
set -e
bin=$1 site=$2
seed=${DEMO_SEED:-7}
rm -rf "$site"
started=$(date +%s)
for station in 1 2 3 4; do
	echo "demo: station $station of 4"
	"$bin/pleinair" scan "$site" --device "sim:court?seed=$seed&station=$station" --preset fine
done
"$bin/pleinair" panoramas "$site"
echo
echo "demo: done in $(($(date +%s) - started)) s. Look at:"
folder=$(cd "$site" && pwd)
echo "    $folder/exports/panoramas/index.html"
echo "The site itself is the folder $folder"
