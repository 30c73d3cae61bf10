#!/bin/sh
# demo.sh BIN SITE: four fine scans of the simulated courtyard, registered into one model; pages that show the panoramas, how the
# scans fit, what was found in them to draw, and the place drawn in every style.
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
"$bin/pleinair" process "$site"
"$bin/pleinair" report "$site"
"$bin/pleinair" pictures "$site"
"$bin/pleinair" export "$site" --output "$site/exports/points.e57"
"$bin/pleinair" export "$site" --output "$site/exports/points-2cm.las" --spacing 0.02
echo "demo: drawing the site in every style"
"$bin/pleinair" styles "$site" --thumbnails "$site/exports/gallery" --size 1200x900
"$bin/pleinair" render "$site" --style line-drawing --view walk --size A3-landscape --output "$site/exports/walk.svg"
echo
echo "demo: done in $(($(date +%s) - started)) s. Look at:"
folder=$(cd "$site" && pwd)
echo "    $folder/exports/gallery/index.html      the place drawn in every style"
echo "    $folder/exports/walk.svg                its edges as a page of lines, for Inkscape"
echo "    $folder/exports/panoramas/index.html    the panoramas"
echo "    $folder/exports/points.e57              all points, for other programs; thinned out to 2 cm in points-2cm.las"
echo "    $folder/exports/report.html             how the four scans fit"
echo "    $folder/exports/pictures/index.html     classes, segments, feature degree, feature and dithering points"
echo "The site itself is the folder $folder"
# Another scan is then one tap away: the scanner that is simulated stands at the next tripod position.
if [ -n "${WAYLAND_DISPLAY:-}${DISPLAY:-}" ] && [ -z "${DEMO_NO_KIOSK:-}" ]; then
	echo "demo: the touch screen opens, with the simulated scanner connected: tap demo-site, and then Scan"
	"$bin/pleinair" kiosk --device "sim:court?seed=$seed&station=%n" "$(dirname "$folder")" ||
		echo "demo: the touch screen could not be opened; all else is done"
else
	echo "With a display, make demo ends on the touch screen: pleinair kiosk --device 'sim:court?seed=$seed&station=%n' $(dirname "$folder")"
fi
