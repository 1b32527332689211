#!/bin/sh
# A long drive keeps its size: resident memory after 30 simulated minutes is what it was after the first minute, and the budget holds.
set -eu
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
first=0 peak=0
# resident size by the kernel's count, a few times a second; the first minute of the drive ends at about 1/30 of the run
while kill -0 $pid 2>/dev/null; do
	now=$(awk '/VmRSS/ { print $2 }' /proc/$pid/status 2>/dev/null || true)
	[ -z "$now" ] || { [ "$now" -le "$peak" ] || peak=$now; }
	kill -USR1 $pid 2>/dev/null || true
	frames=$(jq -r .frames stats.json 2>/dev/null || echo 0)
	[ "$first" -ne 0 ] || [ "${frames:-0}" -lt 120 ] || first=$peak
	sleep 0.2
done
wait $pid || { cat err.txt; exit 1; }
frames=$(jq .frames stats.json)
[ "$frames" -ge 3500 ] || { echo "only $frames frames"; exit 1; }
jq -e '.memory.allocations_after_start == 0' stats.json >/dev/null
echo "resident after one minute: $first KiB, at most: $peak KiB, $frames frames"
# a page or two may come and go with the kernel's accounting
[ "$first" -eq 0 ] || [ "$peak" -le $((first + 512)) ]
