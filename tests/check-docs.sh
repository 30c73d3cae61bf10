#!/bin/sh
# What is written about the tree is true of it: check-docs.sh BUILD. Manual pages have the options that --help has, and no others;
# pleinair.1 names all pages; files that documents name are there; the example of pleinair.conf is one that the programs read. Run from the root.
build=${1:-build}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
status=0
complain() {
	echo "docs: $*" >&2
	status=1
}

options() {
	grep -oE -- '(^|[^a-z-])--[a-z][a-z0-9-]*' | grep -oE -- '--.*' | sort -u
}

# Options of a page are what its section OPTIONS has in front of each paragraph; fonts and escapes are taken off.
told() {
	sed -e 's/\\-/-/g' -e 's/\\f[A-Z]/ /g' "$1" | awk '/^\.SH/ { on = /OPTIONS/ } on && tagged { print } { tagged = /^\.T[PQ]/ }' | options
}

check_page() {
	name=$(basename "$1" .1)
	program=$build/bin/$name
	[ -x "$program" ] || { complain "$1: there is no program $name"; return; }
	"$program" --help 2>&1 | options | grep -vx -e --help >"$work/has"
	sed -e 's/\\-/-/g' -e 's/\\f[A-Z]//g' "$1" | options >"$work/says"
	told "$1" | grep -vx -e --help >"$work/tells"
	for o in $(comm -23 "$work/has" "$work/says"); do complain "$1 does not tell of $o"; done
	for o in $(comm -13 "$work/has" "$work/tells"); do complain "$1 tells of $o, which $name does not have"; done
}

pages=$(ls */*.1 */*/*.1)
if [ -x "$build/bin/pleinair-sim" ]; then
	for page in $pages; do
		[ "$page" = acquire/pleinair.1 ] || check_page "$page"
	done
	for program in "$build"/bin/pleinair-*; do
		echo "$pages" | grep -q "/$(basename "$program")\.1$" || complain "$(basename "$program") has no manual page"
	done
else
	echo "docs: nothing is built in $build, so options were not compared"
fi
sed -n '/^\.SH SEE ALSO/,$s/\\-/-/gp; /^\.SH SEE ALSO/,$p' acquire/pleinair.1 >"$work/also"
for page in $pages $(ls */*.5); do
	name=$(basename "$page") section=${page##*.}
	[ "$name" = pleinair.1 ] || grep -q "^\.BR ${name%.*} ($section)" "$work/also" || complain "pleinair.1 does not name ${name%.*}($section)"
done

# Files: what stands in backticks or is linked to. Names with capitals, as NOUN, stand for others; * and [] are patterns, -x.c is the end of a name.
{ git ls-files --cached --others --exclude-standard 2>/dev/null || find . -type f | sed 's|^\./||'; } | grep -v '^build' >"$work/files"
for document in $(grep '\.md$' "$work/files"); do
	{
		grep -oE '`[A-Za-z0-9_.*/[-]+(\]\.[a-z]+)?`' "$document" | tr -d '`' |
			grep -E '^(firmware-io|acquire|process|render|sim|systemd|tests)/|^[^/]+\.([ch]|cpp|glsl|awk|sh|css|mk)$|\.\[hc\]$'
		grep -oE '\]\([^)#]+\)' "$document" | sed 's/^](//; s/)$//' | grep -v '^[a-z]*:'
	} | grep -vE 'NAME|NOUN' | sort -u | sed "s|^|$document $(dirname "$document")/|"
done >"$work/named"
awk 'function plain(path) { while (sub(/[^\/]+\/\.\.\//, "", path)); sub(/^\.\//, "", path); sub(/\/$/, "", path); return path }
	function pattern(path) { gsub(/\./, "\\.", path); gsub(/\*/, "[^/]*", path)
		return "(^|/)" (path ~ /^-/ ? "[^/]*" : "") path "$" }
	NR == FNR { n = split($0, part, "/"); at = part[1]; names[part[n]] = files[$0] = 1
		for (i = 2; i <= n; i++) { files[at] = 1; at = at "/" part[i] }
		next }
	{ path = $2; here = $1; sub(/[^\/]*$/, "", here); sub("^" (here == "" ? "\\./" : here), "", path)
		if (plain($2) in files || plain(path) in files || path in names) next
		wanted = pattern(path)
		for (f in files) if (f ~ wanted) next
		print $1 ": " path }' "$work/files" "$work/named" >"$work/missing"
while read -r line; do complain "there is no such file: $line"; done <"$work/missing"

# The example's keys, as whoever scans reads them.
sed -n '/^```ini/,/^```/p' firmware-io/build-your-own-scanner.md | grep -v '^```' >"$work/conf"
if [ -x "$build/bin/pleinair-doctor" ]; then
	PLEINAIR_CONF="$work/conf" "$build/bin/pleinair-doctor" --look "$work" | grep '^BAD *configuration' >"$work/bad" &&
		complain "build-your-own-scanner.md: $(cat "$work/bad")"
fi
[ $status -eq 0 ] && echo "docs: pages tell of the options that there are, and name files that are there"
exit $status
