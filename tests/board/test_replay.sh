#!/bin/sh
# From a map to pictures, twice: the frames are the same byte for byte, the stats add up, nothing was allocated after the start.
set -eu
build=$1
blvd=$build/tools/blvd
boulevard=$build/board/boulevard
map=$2/tests/tools/data/crossing.osm
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

"$blvd" bake -q "$map" -o a.blvd
"$blvd" bake -q "$map" -o b.blvd
cmp a.blvd b.blvd
"$blvd" verify a.blvd >/dev/null
"$blvd" drive a.blvd --seed 4 --minutes 1 -o a.candump
"$blvd" drive a.blvd --seed 4 --minutes 1 -o b.candump
cmp a.candump b.candump

run() {
	"$boulevard" a.blvd --replay a.candump --headless --size 320x180 --fps 8 --every 12 --frames "$1" --stats "$1.json" --record "$1.log" 2>"$1.err" || { cat "$1.err"; exit 1; }
}
run one
run two
[ "$(ls one | wc -l)" -ge 15 ]
diff -r one two
cmp a.candump one.log

jq -e '.memory.allocations_after_start == 0' one.json >/dev/null || { echo 'something allocates after the start'; exit 1; }
jq -e '.memory.gpu_high_water_bytes + .memory.cpu_high_water_bytes <= .memory.budget_bytes' one.json >/dev/null
jq -e '.vehicle.frames_bad == 0 and .vehicle.frames_in > 1000 and .cells.damaged_chunks == 0' one.json >/dev/null
jq -e '.route.off_street_frames == 0 and .route.reroutes == 0' one.json >/dev/null || { echo 'the car left its street'; cat one.json; exit 1; }
jq -e '(.frames > 200) and (.size == [320, 180]) and (.far | type == "string") and (.tau_px == 0)
	and (.frame_ms | has("median") and has("p95") and has("p99") and has("p999") and has("max"))
	and (.triangles | has("median") and has("p99") and has("max")) and has("far_triangles") and has("draws")
	and (.cells | has("entered") and has("late_frames") and has("fallback_frames"))
	and (.memory | has("peak_rss_bytes")) and (.start_ms | has("first_frame")) and (.vehicle | has("stale_ms_max"))' one.json >/dev/null
echo 'replayed twice, the same'
