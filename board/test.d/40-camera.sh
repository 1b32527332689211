#!/bin/sh
# the reversing camera: picture by the lever's contact, gone after it; unplugged, silent, frozen; without a map
needs_pins
command -v v4l2-ctl >/dev/null || skip 'v4l2-ctl is missing (v4l-utils)'
[ -c /dev/video0 ] || skip 'no camera here'

camera_set() { v4l2-ctl -d /dev/video0 -c "$1"; } # CONTROL=VALUE
# has_colours FORMAT, looks_like NAME FORMAT: what is on the screen; a picture that comes too late for it is words.
has_colours() {
	screen "camera-$1"
	at_least 100 "$(colours "camera-$1")"
}
looks_like() {
	screen "camera-$2"
	at_most 31000 "$(differ "camera-$1" "camera-$2")"
}
# profile FORMAT: the emulator's with that format
profile() { sed "s/^fps = 30/fps = 30\nformat = $1/" /usr/share/boulevard/profiles/emulator.ini >/run/camera.ini; }

close_pin ignition
unit_start
seconds 1
screen camera-map
close_pin reverse
check 'reverse brings a picture within 2 s' within 2 more_than shown 0
seconds 1
screen camera-reverse
check 'the screen shows it' at_least 25000 "$(differ camera-map camera-reverse)"
open_pin reverse
seconds 1
screen camera-after
check 'and the map again when reverse is left' at_most 25000 "$(differ camera-map camera-after)"

count=0
while [ $count -lt 10 ]; do
	close_pin reverse
	seconds 0.7
	open_pin reverse
	seconds 0.7
	count=$((count + 1))
done
check 'ten times reverse are ten pictures' test "$(camera_state reversed)" = 11
oldest=$(native "$(camera_state 'age_max_ms | floor')")
check 'no picture is older than 200 ms, native' at_most 200 "$oldest"
note 'oldest picture, native ms' "$oldest"

close_pin reverse
within 3 shows_picture
holds 'camera unplugged' camera_unplug
check 'an unplugged camera is known as such' within 2 more_than missing 0
seconds 0.5
screen camera-missing
camera_plug
check 'plugged in again, its picture is back within 2 s' within 2 shows_picture
note 'plugged in to picture, with the asking, native ms' "$took_ms"

frozen=$(camera_state frozen)
check 'the camera can be silenced' camera_set percentage_of_dropped_buffers=100
check 'a silent camera is known as frozen' within 2 more_than frozen "$frozen"
seconds 0.3
screen camera-frozen
camera_set percentage_of_dropped_buffers=0
check 'and live again' within 4 shows_picture
frozen=$(camera_state frozen)
camera_set osd_text_mode=2
check 'a camera that repeats its picture is known as frozen' within 2 more_than frozen "$frozen"
camera_set osd_text_mode=0
check 'and live again with a picture that moves' within 4 shows_picture
check 'the unit was never restarted' test "$(unit_restarts)" = 0

for format in yuyv uyvy nv12 bgrx; do
	profile $format
	UNIT_PROFILE=/run/camera.ini unit_start
	check "$format is agreed on" within 5 sh -c "journalctl -u boulevard -o cat --no-pager | tail -20 | grep -q '$format 640x360.* taken'"
	check "$format is shown" within 5 shows_picture
	if [ $format = yuyv ]; then
		check 'yuyv is on the screen' within 3 has_colours yuyv
	else
		check "$format looks like yuyv does" within 3 looks_like yuyv $format
	fi
done
profile yuyv
sed -i 's/^fps = 30/&\nzero_copy = yes/' /run/camera.ini
UNIT_PROFILE=/run/camera.ini unit_start
check 'buffers that the driver would break on are not given to it' within 5 shows_picture
check 'they are copied, and that is told' sh -c "journalctl -u boulevard -o cat --no-pager | tail -20 | grep -q 'its buffers are copied'"
screen camera-refused
check 'and look like the others' at_most 25000 "$(differ camera-yuyv camera-refused)"
profile mjpeg
UNIT_PROFILE=/run/camera.ini unit_start
seconds 1
check 'a format that the device does not have is told' sh -c "journalctl -u boulevard -o cat --no-pager | tail -20 | grep -q 'no mjpeg picture'"
check 'and the unit runs on' unit_running

head -c 100000 "$CITY" >/run/damaged.blvd
UNIT_CITY=/run/damaged.blvd unit_start
check 'a damaged city leaves the camera alone' within 5 shows_picture
screen camera-no-map
open_pin reverse
seconds 1
screen camera-notice
check 'without reverse the screen says so' at_least 5 "$(colours camera-notice)"
check 'the unit runs without a map' unit_running
