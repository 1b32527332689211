# The golden scenes, all of tests/tools/data/crossing.osm: pictures BUILD SOURCE FOLDER writes PNGs, of 480x270 and 640x360.
# Those of the reversing picture are of the simulated camera.
# shellcheck shell=sh disable=SC2034 # scenes is for those who read this file
scenes='street junction park night replay menu menu-night reverse reverse-night reverse-frozen reverse-missing'

still() {
	"$build/tools/blvd" shot city.blvd --size 480x270 "$@"
}

# Frame 10 of the same drive, with the menu open: menu NAME SCRIPT_LINE...
menu() {
	name=$1
	shift
	printf '%s\n' "$@" >script &&
		"$build/board/boulevard" city.blvd --replay drive.candump --headless --size 640x360 --fps 5 --limit 11 \
			--every 10 --frames menu --gpio sim:script &&
		mv "$(find menu -name '*.png' | sort | tail -n 1)" "$name.png"
}

# Frame 60, twelve seconds into the drive.
replay() {
	"$build/tools/blvd" drive city.blvd --seed 4 --minutes 1 -o drive.candump &&
		"$build/board/boulevard" city.blvd --replay drive.candump --headless --size 480x270 --fps 5 --limit 61 \
			--every 60 --frames frames &&
		mv "$(find frames -name '*.png' | sort | tail -n 1)" replay.png
}

# reversing NAME WHEEL STYLE CAMERA: one second after reverse was put in; WHEEL is the steering signal's two bytes.
reversing() {
	awk -v wheel="$2" 'BEGIN { for (i = 0; i < 60; i++) printf "(%.3f) vcan0 100#000001%s000000\n", 1e9 + i / 50, wheel }' >reverse.candump &&
		{ cat car.ini && printf '[display]\nstyle = %s\n' "$3"; } >style.ini &&
		"$build/board/boulevard" city.blvd --profile style.ini --replay reverse.candump --headless --size 480x270 \
			--fps 5 --limit 6 --every 5 --camera "$4" --frames "$1" &&
		mv "$1/frame-000005.png" "$1.png"
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
			replay &&
			menu menu '0.2 push 1' '0.3 push 0' '0.5 knob +1' &&
			menu menu-night '0 night 1' '0.2 push 1' '0.3 push 0' '0.5 knob +2' '0.7 push 1' '0.8 push 0' \
				'1.0 knob +4' '1.1 view gone' &&
			cp "$2/tests/board/data/reverse.ini" car.ini && cp "$2/tests/board/data/reverse.dbc" . &&
			reversing reverse 0000 day sim:640x360 &&
			reversing reverse-night B80B night sim:640x360,nv12 &&
			reversing reverse-frozen 0000 day sim:640x360,frozen@0+9 &&
			reversing reverse-missing 0000 night sim:640x360,missing@0+9
	) >"$3/log" 2>&1 || {
		cat "$3/log"
		return 1
	}
}
