#!/bin/sh
# fuzz.sh SECONDS CFLAGS LIBS TARGET.c...: builds each target with libFuzzer, ASan and UBSan and runs it on its corpus.
seconds=$1 cflags=$2 libs=$3
shift 3
mkdir -p build-fuzz
sources=$(ls firmware-io/*.c acquire/*.c process/*.c | grep -v '/pleinair')
# PCL itself is as Debian built it; its bridges are instrumented like all else.
bridges=
for bridge in process/*_pcl.cpp; do
	object=build-fuzz/$(basename "$bridge" .cpp).o
	bridges="$bridges $object"
	[ "$object" -nt "$bridge" ] && continue
	# shellcheck disable=SC2086
	clang++ -std=c++17 -I. -D_GNU_SOURCE -DG_LOG_DOMAIN='"pleinair"' -O1 -g -fsanitize=fuzzer-no-link,address,undefined \
		-fno-sanitize=vptr,function -fno-sanitize-recover=all -Wno-unknown-pragmas $cflags -c -o "$object" "$bridge" || exit 1
done
for target; do
	name=$(basename "$target" .c)
	corpus=tests/corpus/${name#fuzz-}
	echo "fuzz: $name for $seconds s"
	# shellcheck disable=SC2086
	clang -std=gnu17 -I. -D_GNU_SOURCE -DG_LOG_DOMAIN='"pleinair"' -O1 -g -fsanitize=fuzzer,address,undefined \
		-fno-sanitize-recover=all -Wno-unknown-pragmas $cflags -o "build-fuzz/$name" "$target" $sources $bridges $libs || exit 1
	mkdir -p "build-fuzz/found-$name"
	"build-fuzz/$name" -max_total_time="$seconds" -timeout=10 -rss_limit_mb=2048 -print_final_stats=1 \
		-artifact_prefix="build-fuzz/$name-" "build-fuzz/found-$name" "$corpus" 2>"build-fuzz/$name.log" || {
		tail -n 40 "build-fuzz/$name.log"
		exit 1
	}
	grep -E 'stat::number_of_executed_units|stat::average_exec' "build-fuzz/$name.log"
done
