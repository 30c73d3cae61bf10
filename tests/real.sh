#!/bin/sh
# real.sh BIN DATA FOLDER [WxH]: every scan in a folder of scans, imported, processed and drawn in eight styles, on one page. Each folder in DATA is a place whose
# files belong together, and so is each file that lies in DATA itself.
set -e
bin=$1 data=$2 folder=$3 size=${4:-1200x900}
styles=points,figure-7d,pencil,stippling,coloured-crayons,watercolour,oil,line-drawing
started=$(date +%s)
if [ ! -d "$data" ]; then
	echo "real: there is no folder '$data' with scans; make real DATA=FOLDER takes another one" >&2
	exit 1
fi
mkdir -p "$folder"

# What pleinair-import(1) takes; small texts are licences and the like.
scans_in() {
	{
		find "$1" -maxdepth 1 -type f -iregex '.*\.\(ptx\|e57\|ply\|pcd\|las\|off\|obj\|xyz\|asc\|pts\)'
		find "$1" -maxdepth 1 -type f -size +8 -iregex '.*\.\(txt\|csv\)'
	} | sort
}

# place NAME FILE...: a site of these, and what is to be drawn of it in $@ of the page.
failed=0 sites= sweeps=$folder/sweeps
: >"$sweeps"
place() {
	name=$1
	shift
	echo "real: $name"
	rm -rf "${folder:?}/$name"
	if ! "$bin/pleinair" import "$folder/$name" "$@" >"$folder/$name.txt" ||
		! "$bin/pleinair" process "$folder/$name" >>"$folder/$name.txt"; then
		echo "real: $name could not be made: $folder/$name.txt" >&2
		failed=$((failed + 1))
		return
	fi
	tail -n +1 "$folder/$name.txt" | sed 's/^/    /'
	caption=$(sed -nE 's!.*/([^/]+), ([0-9]+ points.*)!\1: \2!p; s/^register: (.*) \(.*/\1/p; s/^segments: (.*) \(.*/\1/p' "$folder/$name.txt" |
		tr '|\n' '/;' | sed 's/;$/./; s/;/; /g')
	printf '%s | %s | %s:site=%s\n' "$name" "$caption" "$styles" "$name" >>"$sweeps"
	sites="$sites
$folder/$name"
}

list=$folder/places
{
	for of in "$data"/*/; do
		[ -n "$(scans_in "$of")" ] && printf '%s\n' "$of"
	done
	scans_in "$data"
} >"$list"
if [ ! -s "$list" ]; then
	echo "real: there are no scans in '$data'" >&2
	exit 1
fi
count=$(wc -l <"$list") done_places=0
while read -r of; do
	elapsed=$(($(date +%s) - started))
	[ "$done_places" -gt 0 ] && echo "real: $done_places of $count places, about $((elapsed * (count - done_places) / done_places / 60 + 1)) min left"
	done_places=$((done_places + 1))
	if [ -d "$of" ]; then
		IFS='
'
		# shellcheck disable=SC2046
		set -- $(scans_in "$of")
		unset IFS
		place "$(basename "$of")" "$@"
	else
		place "$(basename "${of%.*}")" "$of"
	fi
done <"$list"

echo "real: drawing"
IFS='
'
# shellcheck disable=SC2086
set -- $sites
unset IFS
while read -r line; do
	set -- "$@" --sweep "$line"
done <"$sweeps"
"$bin/pleinair" styles "$@" --size "$size" --title "Real scans" --output "$folder/pictures"
echo
echo "real: $((count - failed)) of $count places in $(($(date +%s) - started)) s. Look at $(cd "$folder/pictures" && pwd)/index.html"
[ "$failed" -eq 0 ]
