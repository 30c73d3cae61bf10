#!/bin/sh
# fuzz.sh SECONDS CFLAGS CXXFLAGS LIBS TARGET.c...: builds the product and each target with libFuzzer, ASan and UBSan, and runs
# each target on its corpus.
seconds=$1 cflags=$2 cxxflags=$3 libs=$4
shift 4
rm -rf build-fuzz/objects
mkdir -p build-fuzz/objects
common="-I. -D_GNU_SOURCE -O1 -g -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all -Wno-unknown-pragmas -Wno-psabi"
# PCL itself is as Debian built it; its bridges are instrumented like all else. One object each, in a library: a target takes what it needs. File names differ by their folders.
jobs=$(nproc)
for source in $(ls firmware-io/*.c acquire/*.c process/*.c process/*.cpp render/*.c render/*.cpp 2>/dev/null | grep -v '/pleinair'); do
	echo "$source"
done | xargs -P "$jobs" -I{} sh -c '
	source=$1 object=build-fuzz/objects/$(echo "$1" | tr / _).o
	case $source in
	*.cpp) exec clang++ -std=c++17 -DG_LOG_DOMAIN="\"pleinair\"" $2 $3 -fno-sanitize=vptr,function -c -o "$object" "$source" ;;
	*) exec clang -std=gnu17 -DG_LOG_DOMAIN="\"pleinair\"" $2 -c -o "$object" "$source" ;;
	esac' sh {} "$common $cflags" "$cxxflags" || exit 1
rm -f build-fuzz/product.a
ar rcs build-fuzz/product.a build-fuzz/objects/*.o || exit 1
for target; do
	name=$(basename "$target" .c)
	corpus=tests/corpus/${name#fuzz-}
	echo "fuzz: $name for $seconds s"
	# shellcheck disable=SC2086
	clang -std=gnu17 $common -DG_LOG_DOMAIN='"pleinair"' $cflags -c -o "build-fuzz/$name.o" "$target" || exit 1
	# By clang++, which takes new and delete over too: else leaks in C++ libraries end at libstdc++, and no suppression knows them.
	# shellcheck disable=SC2086
	clang++ $common -fsanitize=fuzzer -o "build-fuzz/$name" "build-fuzz/$name.o" build-fuzz/product.a $libs || exit 1
	mkdir -p "build-fuzz/found-$name"
	LSAN_OPTIONS=suppressions=tests/lsan.supp "build-fuzz/$name" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
		-artifact_prefix="build-fuzz/$name-" "build-fuzz/found-$name" "$corpus" 2>"build-fuzz/$name.log" || {
		tail -n 40 "build-fuzz/$name.log"
		exit 1
	}
	grep -E 'stat::number_of_executed_units|stat::average_exec' "build-fuzz/$name.log"
done
