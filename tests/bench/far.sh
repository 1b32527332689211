#!/bin/sh
# Frame time against the size of the city, on the same street: one made-up city cut to three sizes around its middle, one drive through
# the smallest, `blvd tradeoff` on each. What is done already is not done again, so it may be stopped. Arguments: the build folder, a
# folder for everything, and optionally the frames to draw of each (default 300). Wants jq.
set -eu
blvd=$1/tools/blvd
out=$2
frames=${3:-300}
mkdir -p "$out"

# km across and their names: about 0.14, 1 and 5 million triangles
sizes="0.75 2.15 5.3"
[ -s "$out/city.osm" ] || "$blvd" synth --seed 7 --size 5.3x5.3 -o "$out/city.osm"

# W,S,E,N of a square of so many km around 47.05 N 8.15 E, where blvd synth puts its middle
square() {
	awk -v km="$1" 'BEGIN {
		lat = km / 2 / 111.2
		lon = km / 2 / (111.3195 * cos(47.05 * 3.14159265 / 180))
		printf "%.6f,%.6f,%.6f,%.6f", 8.15 - lon, 47.05 - lat, 8.15 + lon, 47.05 + lat
	}'
}

for km in $sizes; do
	[ -s "$out/$km.blvd" ] || "$blvd" bake -q "$out/city.osm" --bbox "$(square "$km")" -o "$out/$km.blvd"
	[ -s "$out/drive.candump" ] || "$blvd" drive "$out/$km.blvd" --seed 2 --minutes 1 -o "$out/drive.candump"
	"$blvd" tradeoff "$out/$km.blvd" --replay "$out/drive.candump" -o "$out/$km" --tau 1 --far none,pvs,impostor \
		--frames "$frames" --every 50 >/dev/null
done

{
	echo '| city | triangles | representation | median ms | p99 ms | speed-up | triangles drawn | resident MiB | FLIP | displaced <= 1 px |'
	echo '|---|---|---|---|---|---|---|---|---|---|'
	for km in $sizes; do
		jq -r --arg km "$km" '.packages[0].triangles as $all | .settings[] |
			"| \($km) km | \($all) | \(.representation) | \(.cpu_ms_median * 10 | round / 10) | \(.cpu_ms_p99 * 10 | round / 10) | \(.speed_up * 100 | round / 100)x | \(.triangles_median) | \(.resident_bytes / 104857.6 | round / 10) | \(.flip * 10000 | round / 10000) | \(.displaced_within_1_px * 100000 | round / 1000) % |"' \
			"$out/$km/summary.json"
	done
	echo
	for name in full none pvs impostor; do
		small=$(jq --arg name $name '.settings[] | select(.representation == $name) | .cpu_ms_median' "$out/0.75/summary.json")
		large=$(jq --arg name $name '.settings[] | select(.representation == $name) | .cpu_ms_median' "$out/5.3/summary.json")
		echo "Largest against smallest, same street, $name: $(awk -v a="$large" -v b="$small" 'BEGIN { printf "%.2fx", a / b }')  "
	done
} >"$out/table.md"
cat "$out/table.md"
