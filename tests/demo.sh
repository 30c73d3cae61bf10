#!/bin/sh
# demo.sh BIN SITE: four fine scans of the simulated courtyard, registered into one model, and one page that shows the place drawn in every style, as a page of
# lines and as a film, and how the scans fit.
set -e
bin=$1 site=$2
seed=${DEMO_SEED:-7}
rm -rf "$site"

# step SECONDS WHAT COMMAND...: of all that is to be done, SECONDS by a machine of two cores, tells how long the rest may take by how
# fast this one is.
started=$(date +%s) all=320 done_s=0
step() {
	seconds=$1 what=$2
	shift 2
	elapsed=$(($(date +%s) - started))
	if [ "$done_s" -gt 0 ]; then
		left=$((elapsed * (all - done_s) / done_s))
	else
		left=$all
	fi
	echo "demo: $what ($((100 * done_s / all)) % done, about $(((left + 30) / 60)) min left)"
	"$@"
	done_s=$((done_s + seconds))
}

# at_once WORDS COMMAND... COMMAND...: two that keep a core busy each; the first has so many words. What it says is shown when both are done.
at_once() {
	words=$1 said=$(mktemp) second=0 first=0
	shift
	(
		all=$# n=0
		for word; do
			[ "$n" -ge "$words" ] || set -- "$@" "$word"
			n=$((n + 1))
		done
		shift "$all"
		OMP_WAIT_POLICY=passive exec "$@"
	) >"$said" 2>&1 &
	shift "$words"
	OMP_WAIT_POLICY=passive "$@" || second=$?
	wait $! || first=$?
	cat "$said"
	rm -f "$said"
	return $((first + second))
}

for station in 1 2 3 4; do
	step 10 "station $station of 4 is scanned" "$bin/pleinair" scan "$site" --device "sim:court?seed=$seed&station=$station" --preset fine
done
step 5 "panoramas" "$bin/pleinair" panoramas "$site"
step 80 "the scans are registered, and what they show is found" "$bin/pleinair" process "$site"
step 10 "how well they fit, and points for other programs" at_once 3 "$bin/pleinair" report "$site" \
	"$bin/pleinair" export "$site" --output "$site/exports/points.e57"
step 15 "pictures of what was found, and the points thinned out" at_once 3 "$bin/pleinair" pictures "$site" \
	"$bin/pleinair" export "$site" --output "$site/exports/points-2cm.las" --spacing 0.02
step 10 "a page of lines" "$bin/pleinair" render "$site" --style line-drawing --view walk --size A3-landscape --output "$site/exports/walk.svg"
step 40 "a film" "$bin/pleinair" render "$site" --style ink-and-wash --view walk --path orbit:6 --seconds 4 --size 960x540 --output "$site/exports/walk.mp4"
step 110 "the place in every style" "$bin/pleinair" styles "$site" --thumbnails "$site/exports/gallery" --size 1200x900 \
	--with "$site/exports/walk.mp4" --with "$site/exports/walk.svg" --with "$site/exports/report.html" \
	--with "$site/exports/panoramas/index.html"
echo
echo "demo: done in $(($(date +%s) - started)) s. Look at:"
folder=$(cd "$site" && pwd)
echo "    $folder/exports/gallery/index.html      the place in every style, as a film and as lines, and how the scans fit"
echo "    $folder/exports/walk.svg                its edges as a page of lines, for Inkscape"
echo "    $folder/exports/panoramas/index.html    the panoramas"
echo "    $folder/exports/points.e57              all points, for other programs; thinned out to 2 cm in points-2cm.las"
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
