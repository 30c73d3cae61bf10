#!/bin/sh
# Texts of the touch screen and their translations: texts.sh update takes new ones over into the .po files, texts.sh check fails where
# one is missing, not translated or doubtful. Run from the root.
set -e
po=render/kiosk/po
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

collect() {
	sed -n 's/^[[:space:]]*"title": \("[^"]*"\).*/_(\1);/p' render/styles/*.json > "$work/style-titles.c"
	# Parameters of steps and sections as step-sliders.c says them ("length_px" is "Length"), their choices, and what they are.
	awk 'function say(text) { if (text != "") print "_(\"" text "\");" }
		function titled(name) { sub(/_(px|deg|m|s)$/, "", name); gsub(/_/, " ", name)
			return toupper(substr(name, 1, 1)) substr(name, 2) }
		{ indent = match($0, /[^ ]/) - 1; split($0, part, "\""); key = part[2] }
		indent == 4 { is_kind = key !~ /^(change|node|step|segments)/; if (key ~ /^(paper|light|focus)$/) say(titled(key)) }
		indent == 6 && key == "title" && is_kind { say(part[4]) }
		indent == 8 && is_kind { is_parameter = /: \{$/ && key !~ /^(step|id)$/; if (is_parameter) say(titled(key)) }
		indent == 10 && is_parameter && key == "description" { sub(/ \((px|m|degrees)\)$/, "", part[4]); say(part[4]) }
		indent == 10 && is_parameter && key == "enum" { for (i = 4; i in part; i += 2) say(part[i]) }' \
		render/style.schema.json | sort -u > "$work/parameters.c"
	xgettext --from-code=UTF-8 --keyword=_ --keyword=N_ --keyword=ngettext:1,2 --add-location=file --sort-by-file \
		--package-name=pleinair --directory=. --directory="$work" --output="$work/pleinair.pot" \
		render/kiosk/*.c acquire/advice.c acquire/doctor*.c style-titles.c parameters.c 2>"$work/said" || { cat "$work/said" >&2; exit 1; }
	# The day of every run would be a change of its own.
	sed -i '/^"POT-Creation-Date/d' "$work/pleinair.pot"
}

update() {
	collect
	cp "$work/pleinair.pot" $po/pleinair.pot
	for f in $po/*.po; do
		msgmerge --quiet --update --no-fuzzy-matching --sort-by-file --add-location=file --backup=none "$f" $po/pleinair.pot
		msgattrib --no-obsolete --add-location=file --sort-by-file --output-file="$f" "$f"
		echo "$f: $(LC_ALL=C msgfmt --statistics -o /dev/null "$f" 2>&1)"
	done
}

check() {
	collect
	for f in $po/*.po; do
		msgfmt --check --output-file=/dev/null "$f"
		msgcmp "$f" "$work/pleinair.pot" 2>"$work/said" || {
			grep -v warning: "$work/said" | head -20 >&2
			echo "$f: run make pot, and translate what has no msgstr then" >&2
			exit 1
		}
	done
	echo "translations: every text of the touch screen has one"
}

"$1"
