# The golden scenes, all of tests/tools/data/crossing.osm: pictures BUILD SOURCE FOLDER writes five PNGs of 480x270.
# shellcheck shell=sh disable=SC2034 # scenes is for those who read this file
scenes='street junction park night replay'

still() {
	"$build/tools/blvd" shot city.blvd --size 480x270 "$@"
}

# Frame 60, twelve seconds into the drive.
replay() {
	"$build/tools/blvd" drive city.blvd --seed 4 --minutes 1 -o drive.candump &&
		"$build/board/boulevard" city.blvd --replay drive.candump --headless --size 480x270 --fps 5 --limit 61 \
			--every 60 --frames frames &&
		mv "$(find frames -name '*.png' | sort | tail -n 1)" replay.png
}

pictures() {
	build=$1
	(
		cd "$3" &&
			"$build/tools/blvd" bake -q "$2/tests/tools/data/crossing.osm" -o city.blvd &&
			still --camera driver --pose=-53,-140,0,0,0 -o street.png &&
			still --pose=-62,-97,9,12,-13 -o junction.png &&
			still --pose=-30,45,55,308,-32 -o park.png &&
			still --camera driver --pose=-53,-140,0,0,0 --time 23:30 -o night.png &&
			replay
	) >"$3/log" 2>&1 || {
		cat "$3/log"
		return 1
	}
}
