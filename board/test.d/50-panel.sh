#!/bin/sh
# how the panel is driven: the mode asked for, turned by 90, 180 and 270 degrees, darker, fewer pictures at standstill
needs_panel

# start_with LINE: the unit with the emulator's profile and these keys of [display] more.
start_with() {
	sed "s/^\[display\]/[display]\n$1/" /usr/share/boulevard/profiles/emulator.ini >/run/panel.ini
	UNIT_PROFILE=/run/panel.ini unit_start
}
detail() { stat_of .display.detail; }
said() { unit_log --since "$started" | grep -q "$1"; }
pixel() { board_screen pixel "$OUT/$1.png" "$2" "$3"; }
channel() { echo $((0x$(echo "$1" | cut -c"$2"))); }
# alike RRGGBB RRGGBB [SHARE]: within 16 of 255 in each channel, the second as bright as SHARE of 100 of the first.
alike() {
	for digits in 1-2 3-4 5-6; do
		distance=$(($(channel "$1" $digits) * ${3:-100} / 100 - $(channel "$2" $digits)))
		[ ${distance#-} -le 16 ] || return 1
	done
}
# alike_places NAME NAME DEGREES [SHARE]: how many of 35 places of the first picture are found in the second, which is
# turned by so much; both of 1024 x 768.
alike_places() {
	found=0
	for x in 100 230 360 490 620 750 880; do
		for y in 90 220 350 480 610; do
			case $3 in
			0) there="$x $y" ;;
			90) there="$((1023 - y * 1024 / 768)) $((x * 768 / 1024))" ;;
			180) there="$((1023 - x)) $((767 - y))" ;;
			270) there="$((y * 1024 / 768)) $((767 - x * 768 / 1024))" ;;
			esac
			# shellcheck disable=SC2086 # two numbers
			! alike "$(pixel "$1" $x $y)" "$(pixel "$2" $there)" "${4:-100}" || found=$((found + 1))
		done
	done
	echo $found
}
pictures_in() { board_screen watch "$1" | jq .pictures; }

ignition_on
started=$(date +%T)
check 'it starts with the mode that is asked for' start_with 'mode = 800x600'
drive_start 20
check 'pictures come' within 10 pictures_come
drive_stop
check 'the mode is the one that was asked for' sh -c "echo '$(detail)' | grep -q 800x600"
screen panel-mode
check 'the picture fills it' pixel panel-mode 799 599
check 'and no more' sh -c "! board_screen pixel '$OUT/panel-mode.png' 800 599"

check 'it starts without the mode that is asked for' start_with 'mode = 1234x567'
check 'the next best is taken' sh -c "echo '$(detail)' | grep -q '[0-9]x[0-9]'"
check 'and told' said 1234x567

# From here on a car that stands where it was left: the same picture every time.
check 'it starts upright' start_with 'rotation = 0'
seconds 3
screen panel-0
for turned in 90 180 270; do
	check "it starts turned by $turned degrees" start_with "rotation = $turned"
	seconds 3
	screen panel-$turned
	check "turned by $turned degrees it is the same picture" at_least 28 "$(alike_places panel-0 panel-$turned $turned)"
done
check 'and no other turn is' at_most 18 "$(alike_places panel-0 panel-90 270)"

check 'it starts darker' start_with 'brightness_day = 0.4'
seconds 5
screen panel-dark
check 'the picture is 0.4 times as bright' at_least 28 "$(alike_places panel-0 panel-dark 0 40)"

check 'it starts with fewer pictures at standstill' start_with 'fps_standstill = 2'
seconds 3
standing=$(pictures_in "$(awk "BEGIN { print 4 * $SLOW }")")
drive_start 20
seconds 4
driving=$(pictures_in "$(awk "BEGIN { print 4 * $SLOW }")")
note 'pictures in 4 s, standing and driving' "$standing $driving"
check 'a standing car is drawn twice a second' at_most "$(awk "BEGIN { print 8 * $SLOW + 2 }")" "$standing"
check 'a driving one more often' at_least "$((standing * 2))" "$driving"
