#!/bin/sh
# A drive with two representations: killed and gone on with it gives the same files as in one go, but for times; a folder is not
# mixed with another run; all that is promised is written.
set -eu
build=$1
blvd=$build/tools/blvd
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir"

"$blvd" bake -q "$2/tests/tools/data/crossing.osm" -o a.blvd
"$blvd" drive a.blvd --seed 4 --minutes 1 -o a.candump 2>/dev/null
trade() {
	to=$1
	shift
	"$blvd" tradeoff a.blvd --replay a.candump -o "$to" --far none --size 160x96 --fps 8 --frames 120 --every 40 --pictures 1 "$@"
}
trade whole >out 2>err || { cat err; exit 1; }
trade parts >out 2>err &
pid=$!
tries=0
while [ ! -e parts/tau-1/none-0000.csv ] && [ $tries -lt 600 ]; do
	sleep 0.1
	tries=$((tries + 1))
done
kill -9 $pid 2>/dev/null || true
wait $pid 2>/dev/null || true
trade parts >out 2>err || { cat err; exit 1; }

for file in full-0000 full-0001 full-0002 none-0000 none-0001 none-0002; do
	for run in whole parts; do
		[ -s "$run/tau-1/$file.csv" ] || { echo "no $run/tau-1/$file.csv"; exit 1; }
		sed 's/,[^,]*,[^,]*$//' "$run/tau-1/$file.csv" >"$run-$file"
	done
	cmp "whole-$file" "parts-$file" || { diff "whole-$file" "parts-$file"; exit 1; }
done
diff -r whole/tau-1/pictures parts/tau-1/pictures
[ "$(ls whole/tau-1/pictures | wc -l)" = 4 ] # full; none, its difference, its displacement
[ "$(cat whole/tau-1/none-*.csv | grep -vc frame)" = 120 ]
ls whole/tau-1 | grep -q part && { echo 'a part of a file was left'; exit 1; }

jq -e '(.settings | length == 2) and (.settings[0].representation == "full") and (.settings[1].speed_up > 0)
	and (.settings[1] | has("flip") and has("displaced_within_1_px") and has("uncovered_worst") and has("popping_ratio"))
	and (.table | length >= 10) and (.packages[0].triangles > 1000)' whole/summary.json >/dev/null || { cat whole/summary.json; exit 1; }
grep -q '^| far pixels displaced' whole/table.md
grep -q '<svg' whole/index.html
[ "$(wc -l <whole/settings.csv)" = 3 ]

# wrong use and bad input
status() {
	set +e
	"$@" >out 2>err
	got=$?
	set -e
}
status trade whole --samples 2
[ $got = 2 ] || { echo "other settings: $got"; exit 1; }
grep -q 'settings.txt' err
status "$blvd" tradeoff a.blvd --replay a.candump
[ $got = 2 ] || { echo "usage: $got"; exit 1; }
status "$blvd" tradeoff a.blvd --replay a.candump -o x --far hologram
[ $got = 2 ] || { echo "representation: $got"; exit 1; }
status "$blvd" tradeoff a.candump --replay a.candump -o x -q
[ $got = 3 ] || { echo "no package: $got"; exit 1; }
status "$blvd" tradeoff a.blvd --replay a.blvd -o y -q
[ $got = 3 ] || { echo "no log: $got"; exit 1; }
echo 'stopped and gone on with: the same'
