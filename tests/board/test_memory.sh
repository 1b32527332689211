#!/bin/sh
# A long drive keeps its size: resident memory late in 30 simulated minutes is what it was early, and the budget holds.
set -eu
# sanitizers keep freed memory: their resident size says nothing
grep -q "BLVD_SANITIZE:BOOL=ON" "$1/CMakeCache.txt" && exit 77
build=$1
blvd=$build/tools/blvd
boulevard=$build/board/boulevard
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

"$blvd" bake -q "$2/tests/tools/data/crossing.osm" -o a.blvd
# the small map's streets are soon driven: one drive after another on one bus, time going on
"$blvd" drive a.blvd --seed 2 --minutes 2 -o part.candump 2>/dev/null
awk -v repeats=15 '{
	line[NR] = $0
	time[NR] = substr($1, 2, length($1) - 2) + 0
} END {
	span = time[NR] - time[1] + 0.02
	for (r = 0; r < repeats; r++)
		for (i = 1; i <= NR; i++) {
			rest = line[i]
			sub(/^\([^)]*\)/, "", rest)
			printf "(%.6f)%s\n", time[i] + r * span, rest
		}
}' part.candump >long.candump

"$boulevard" a.blvd --replay long.candump --headless --size 160x96 --samples 1 --fps 2 --stats stats.json 2>err.txt &
pid=$!
early=0 late=0
sleep 1 # the handler of SIGUSR1 is in place by then
# The rasteriser's own scratch memory swings by about 1 MiB from frame to frame without a trend, so the least that the kernel counts in
# the first minutes is held against the least in the last ones, with 2 MiB to spare: a leak of 1 KiB a frame is found.
while kill -0 $pid 2>/dev/null; do
	now=$(awk '/VmRSS/ { print $2 }' /proc/$pid/status 2>/dev/null || true)
	kill -USR1 $pid 2>/dev/null || true
	frames=$(jq -r .frames stats.json 2>/dev/null || echo 0)
	if [ -n "$now" ] && [ "${frames:-0}" -gt 60 ] && [ "$frames" -lt 700 ]; then
		[ $early -ne 0 ] && [ "$now" -ge $early ] || early=$now
	elif [ -n "$now" ] && [ "${frames:-0}" -gt 2400 ]; then
		[ $late -ne 0 ] && [ "$now" -ge $late ] || late=$now
	fi
	sleep 0.1
done
wait $pid || { cat err.txt; exit 1; }
frames=$(jq .frames stats.json)
[ "$frames" -ge 3500 ] || { echo "only $frames frames"; exit 1; }
jq -e '.memory.allocations_after_start == 0' stats.json >/dev/null
echo "held early: $early KiB, late: $late KiB, $frames frames"
[ $early -gt 0 ] && [ $late -gt 0 ] && [ $late -le $((early + 2048)) ]
