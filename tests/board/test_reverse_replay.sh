#!/bin/sh
# Reverse to picture in the whole program: the same twice, without a sound city, and a thousand times without growing.
set -eu
build=$1
boulevard=$build/board/boulevard
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"
profile=$2/tests/board/data/reverse.ini
"$build/tools/blvd" bake -q "$2/tests/tools/data/crossing.osm" -o a.blvd

# gears COUNT: so many seconds of half a second forward, half a second in reverse.
gears() {
	awk -v count="$1" 'BEGIN { for (i = 0; i < count * 20; i++)
		printf "(%.3f) vcan0 100#0000%s0000000000\n", 1e9 + i / 20, i % 20 < 10 ? "03" : "01" }'
}
run() {
	city=$1
	shift
	"$boulevard" "$city" --profile "$profile" --headless --size 160x96 --samples 0 "$@" 2>err.txt
}

gears 4 >short.candump
for i in 1 2; do
	run a.blvd --replay short.candump --fps 10 --camera sim:320x180,frozen@2.5+0.7 --frames "f$i" --stats s$i.json || { cat err.txt; exit 1; }
done
cmp_all() { for file in f1/*.png; do cmp "$file" "f2/$(basename "$file")" || return 1; done; }
cmp_all || { echo 'two replays differ'; exit 1; }
jq -e '.camera.reversed == 4 and .camera.frozen == 1 and .camera.too_old == 0 and .camera.edge_to_picture_ms.max <= 200' s1.json >/dev/null || { jq .camera s1.json; exit 1; }

# A city that is damaged or not there: the camera is shown all the same, and the exit status says what was wrong.
head -c 50000 a.blvd >cut.blvd
for city in cut.blvd nowhere.blvd; do
	status=0
	run $city --replay short.candump --fps 10 --frames f3 --stats s3.json || status=$?
	[ $status -eq 3 ] || { echo "status $status without a city"; cat err.txt; exit 1; }
	grep -q "$city" err.txt || { cat err.txt; exit 1; }
	jq -e '.camera.reversed == 4 and .camera.shown > 10' s3.json >/dev/null || { jq .camera s3.json; exit 1; }
	cmp f1/frame-000007.png f3/frame-000007.png && { echo 'nothing says that there is no map'; exit 1; }
	rm -rf f3
done

# Sanitizers keep freed memory: their resident size says nothing.
grep -q 'BLVD_SANITIZE:BOOL=ON' "$build/CMakeCache.txt" && exit 0
gears 1000 >long.candump
"$boulevard" a.blvd --profile "$profile" --headless --size 96x64 --samples 0 --replay long.candump --fps 2 --camera sim:64x36 --stats s.json 2>err.txt &
pid=$!
early='' late=''
while kill -0 $pid 2>/dev/null; do
	now=$(awk '/VmRSS/ { print $2 }' /proc/$pid/status 2>/dev/null || true) files=$(ls /proc/$pid/fd 2>/dev/null | wc -l)
	kill -USR1 $pid 2>/dev/null || true
	sleep 0.1
	done=$(jq -r .camera.reversed s.json 2>/dev/null || echo 0)
	gpu=$(jq -r .memory.gpu_high_water_bytes s.json 2>/dev/null || echo 0)
	[ -n "$now" ] && [ "$files" -gt 0 ] && [ "${done:-0}" -gt 0 ] || continue
	if [ "$done" -gt 100 ] && [ -z "$early" ]; then
		early=$now early_files=$files early_gpu=$gpu
	fi
	late=$now late_files=$files late_gpu=$gpu
done
wait $pid || { cat err.txt; exit 1; }
jq -e '.camera.reversed == 1000 and .memory.allocations_after_start == 0' s.json >/dev/null || { jq . s.json; exit 1; }
echo "early: ${early:-?} KiB, ${early_files:-?} files, ${early_gpu:-?} bytes on the GPU; late: $late KiB, $late_files files, $late_gpu bytes"
[ -z "$early" ] || { [ "$late" -le $((early + 2048)) ] && [ "$late_files" -le $((early_files + 1)) ] && [ "$late_gpu" = "$early_gpu" ]; }
