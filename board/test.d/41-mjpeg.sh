#!/bin/sh
# a camera that sends JPEG: agreed on, shown, damaged pictures never shown, silent and back, other sizes (not arm64)
needs_pins
device=/dev/video8
[ -c $device ] || skip 'no camera here that a program can play (v4l2loopback)'
command -v mjpeg_camera >/dev/null || skip 'built without libturbojpeg'

said() { unit_log "_PID=$(unit_pid)" | grep -q "$1"; }
# camera KIND [SIZE]: a camera that sends pictures of that kind instead of the one before; camera_end: none
writer=''
camera() {
	camera_end
	mjpeg_camera $device "${2:-640x360}" 30 "$1" &
	writer=$!
}
camera_end() {
	[ -z "$writer" ] || { kill $writer && wait $writer 2>/dev/null; }
	writer=''
}
trap 'camera_end; drive_stop; unit_stop' EXIT
# Damaged pictures are magenta, whole ones grey.
is_magenta() { # of 1024 x 768: beside the guide lines, at the top, in the middle and below
	screen mjpeg-looked
	for place in '60 120' '512 300' '60 500' '960 400' '200 650'; do
		# shellcheck disable=SC2086 # two numbers
		colour=$(board_screen pixel "$OUT/mjpeg-looked.png" $place)
		red=$((0x${colour%????})) green=${colour%??}
		green=$((0x${green#??}))
		[ $red -le $((green + 60)) ] || { echo "$colour at $place"; return 0; }
	done
	return 1
}
never_magenta() {
	looks=0
	while [ $looks -lt "$1" ]; do
		! is_magenta || { cp "$OUT/mjpeg-looked.png" "$OUT/mjpeg-magenta.png"; return 1; }
		looks=$((looks + 1))
	done
}
# How long after $ended the unit said it, native ms.
said_after() {
	at=$(journalctl -u boulevard --no-pager -o short-unix "_PID=$(unit_pid)" | grep "$1" | tail -1 | cut -d' ' -f1)
	native "$(awk "BEGIN { printf \"%d\", ($at - $ended) * 1000 }")"
}

sed "s#^device = /dev/video0#device = $device\nformat = mjpeg#" /usr/share/boulevard/profiles/emulator.ini >/run/mjpeg.ini
close_pin reverse
UNIT_PROFILE=/run/mjpeg.ini unit_start
check 'without a camera: it is missing' within 3 more_than missing 0
screen mjpeg-missing
camera whole
check 'its picture is shown' within 5 shows_picture
check 'the format was agreed on' said 'mjpeg 640x360.* taken'
screen mjpeg-whole
check 'and looks like it' sh -c "! [ \$(board_screen pixel $OUT/mjpeg-whole.png 60 120) = 000000 ]"
check 'the screen shows another picture' at_least 25000 "$(differ mjpeg-missing mjpeg-whole)"
check 'none is bad' test "$(camera_state bad)" = 0
note 'longest decoding of 640x360, native ms' "$(native "$(camera_state 'decode_ms_max * 10 | floor')" | awk '{ print $1 / 10 }')"

for kind in bare padded; do
	frames=$(camera_state frames)
	camera $kind
	check "$kind: is shown" within 5 shows_picture
	seconds 1
	check "$kind: none is bad" test "$(camera_state bad)" = 0
	screen mjpeg-$kind
	check "$kind: looks like a whole one" at_most 76000 "$(differ mjpeg-whole mjpeg-$kind)"
done

camera mixed
seconds 1
bad=$(camera_state bad) frames=$(camera_state frames) frozen=$(camera_state frozen) missing=$(camera_state missing)
check 'every second one damaged: pictures are shown' within 5 shows_picture
check 'every second one damaged: they are never shown' never_magenta 15
bad=$(($(camera_state bad) - bad)) frames=$(($(camera_state frames) - frames))
note 'good and damaged ones meanwhile' "$frames, $bad"
check 'every second one damaged: they are counted' at_least $((frames * 9 / 10)) "$bad"
check 'every second one damaged: it is no frozen camera' test "$(camera_state frozen) $(camera_state missing)" = "$frozen $missing"

for kind in cut torn noise empty; do
	camera whole
	within 5 shows_picture
	told=$(camera_state 'frozen + .camera.missing') bad=$(camera_state bad)
	camera $kind
	check "$kind, nothing else: known as frozen, or missing" within 2 more_than 'frozen + .camera.missing' "$told"
	check "$kind, nothing else: counted" more_than bad "$bad"
	check "$kind, nothing else: never shown" never_magenta 3
done

camera whole
check 'whole ones again: shown' within 5 shows_picture
frozen=$(camera_state frozen)
camera_end
ended=$(date +%s.%N)
check 'silent: known as frozen' within 2 more_than frozen "$frozen"
took=$(said_after 'camera: frozen')
note 'silent to known as frozen, native ms' "$took"
check 'silent: known within 0.5 s' at_most 500 "$took"
screen mjpeg-frozen
check 'silent: words instead of the picture' at_least 6400 "$(differ mjpeg-whole mjpeg-frozen)"
seconds 2
ended=$(date +%s.%N)
camera whole
check 'it sends again: shown' within 5 shows_picture
took=$(said_after 'camera: live')
note 'started again to picture, native ms' "$took"
check 'it sends again: shown within 2 s' at_most 2000 "$took"

camera_end
seconds 2
camera whole 320x240
check 'another size: agreed on' within 5 said 'mjpeg 320x240.* taken'
check 'another size: shown' within 5 shows_picture
screen mjpeg-small

sed -i '/^.camera.$/,$s/^width = .*/width = 160/;/^.camera.$/,$s/^height = .*/height = 120/' /run/mjpeg.ini
UNIT_PROFILE=/run/mjpeg.ini unit_start
check 'larger than the profile allows: told' within 5 said 'no mjpeg picture up to 160 x 120'
not_shown() { ! shows_picture; }
check 'and not shown' not_shown
check 'the unit was never restarted' test "$(unit_restarts)" = 0
