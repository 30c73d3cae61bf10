#!/bin/sh
# Texts of the touch screen and their translations: texts.sh update takes new ones over into the .po files, texts.sh check fails where
# one is missing, not translated or doubtful. Run from the root.
set -e
po=render/kiosk/po
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

collect() {
	sed -n 's/^ *"title": \("[^"]*"\).*/_(\1);/p' render/styles/*.json > "$work/style-titles.c"
	xgettext --from-code=UTF-8 --keyword=_ --keyword=N_ --keyword=ngettext:1,2 --add-location=file --sort-by-file \
		--package-name=pleinair --directory=. --directory="$work" --output="$work/pleinair.pot" \
		render/kiosk/*.c style-titles.c 2>"$work/said" || { cat "$work/said" >&2; exit 1; }
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
