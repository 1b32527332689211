#!/bin/sh
# the camera's buffers as textures: the same picture as by a copy, plugs, formats, nothing kept; needs --mesa (not arm64)
needs_pins
[ -c /dev/video0 ] || skip 'no camera here'
mesa=/usr/lib/boulevard-test/mesa
[ -e $mesa/libEGL_mesa.so.0 ] || skip 'this Mesa takes no buffers of other devices: board/test --mesa "$(board/emulator/backports mesa)"'
UNIT_ENVIRONMENT="LD_LIBRARY_PATH=$mesa
LIBGL_DRIVERS_PATH=$mesa/dri
GBM_BACKENDS_PATH=$mesa/gbm"

# The kernel maps no buffer of another device for a software driver on a card, so there is none here: pictures are files.
frames=/var/lib/boulevard/frames
drop_in=/run/systemd/system/boulevard.service.d/no-card.conf
mkdir -p "${drop_in%/*}"
printf '[Service]\nInaccessiblePaths=/dev/dri\n' >$drop_in
trap 'drive_stop; unit_stop; rm -rf $drop_in $frames' EXIT

# start FORMAT yes|no
start() {
	sed "s/^fps = 30/fps = 30\nformat = $1\nzero_copy = $2\nrepeats = no/" /usr/share/boulevard/profiles/emulator.ini >/run/camera.ini
	rm -rf $frames
	UNIT_PROFILE=/run/camera.ini unit_start --display headless --frames $frames --every 5
}
# picture NAME: one that was begun after now, as $OUT/NAME.png; another one where words were shown meanwhile, instead of a
# picture that would have come too late.
picture() {
	tries=0 words=-1
	while [ $tries -lt 5 ] && [ "$(in_words)" != "$words" ]; do
		words=$(in_words) tries=$((tries + 1))
		last=$(find $frames -name '*.png' | sort | tail -1)
		within 10 newer_ones
		cp "$(find $frames -name '*.png' | sort | tail -2 | head -1)" "$OUT/$1.png"
		find $frames -name '*.png' ! -newer "$last" -delete
	done
}
newer_ones() { [ "$(find $frames -newer "$last" -name '*.png' | wc -l)" -ge 3 ]; }
in_words() { camera_state 'withdrawn + .camera.frozen + .camera.missing'; }
# greatest_step A B: the largest difference in any channel of two pictures, of 255
greatest_step() { board_screen step "$OUT/$1.png" "$OUT/$2.png"; }
in_place_only() { # pictures come, and none by a copy
	copied=$(camera_state copied) in_place=$(camera_state in_place)
	within 4 more_than in_place $((in_place + 3)) && test "$(camera_state copied)" = "$copied"
}
told() { unit_log "_PID=$(unit_pid)" | grep -c "camera: its buffers are $1"; }
files_open() { ls "/proc/$(unit_pid)/fd" | wc -l; }

v4l2-ctl -d /dev/video0 -c osd_text_mode=2 # a picture that stands
close_pin reverse
start yuyv yes
seconds 2
[ "$(told shown)" -ge 1 ] || skip 'the Mesa of --mesa takes no buffers of other devices'
for format in yuyv uyvy bgrx rgbx; do
	start $format yes
	within 5 more_than in_place 3
	check "$format: no copy is made" test "$(camera_state copied)" = 0
	check "$format: that is told once" test "$(told shown)" = 1
	picture zero-copy-$format
	start $format no
	within 5 more_than copied 3
	check "$format, not wanted: only copies" test "$(camera_state in_place)" = 0
	picture copied-$format
	step=$(greatest_step zero-copy-$format copied-$format)
	note "$format: greatest difference of a channel, of 255" "$step"
	check "$format: the same picture with and without" at_most 3 "$step"
done

# What the driver does not take goes by a copy, and that is told once.
start nv12 yes
within 5 more_than shown 3
check 'nv12: is shown, taken or not' more_than shown 3
check 'nv12: and told once' test "$(($(told shown) + $(told copied)))" = 1
picture zero-copy-nv12
start nv12 no
within 5 more_than shown 3
picture copied-nv12
check 'nv12: the same picture with and without' at_most 3 "$(greatest_step zero-copy-nv12 copied-nv12)"

start yuyv yes
within 5 more_than in_place 3
picture zero-copy-before
check 'pictures in place' in_place_only
before=$(files_open)
count=0
while [ $count -lt 3 ]; do
	missing=$(camera_state missing)
	camera_unplug
	check "unplugged: known as such" within 3 more_than missing "$missing"
	camera_plug
	v4l2-ctl -d /dev/video0 -c osd_text_mode=2
	in_place=$(camera_state in_place)
	check 'plugged in: pictures in place' within 5 more_than in_place $((in_place + 3))
	count=$((count + 1))
done
picture zero-copy-after
check 'plugged in three times: the same picture' at_most 3 "$(greatest_step zero-copy-before zero-copy-after)"
check 'three plugs leave no file open' test "$(files_open)" = "$before"
check 'and none was copied' test "$(camera_state copied)" = 0

# Of its own memory: Mesa 25's software driver keeps a mapping of the camera's with every picture, which costs none. The
# first pictures of map and camera after another still need some.
memory() { awk '/^RssAnon/ { print $2 }' "/proc/$(unit_pid)/status"; }
reverse_often() {
	count=0
	while [ $count -lt "$1" ]; do
		open_pin reverse
		sleep 0.45
		close_pin reverse
		sleep 0.2
		count=$((count + 1))
	done
}
before=$(files_open) reversed=$(camera_state reversed)
reverse_often 20
held=$(memory)
reverse_often 80
check 'a hundred times reverse were as many' at_least $((reversed + 95)) "$(camera_state reversed)"
check 'they leave no file open' test "$(files_open)" = "$before"
grown=$(($(memory) - held))
note 'the last eighty of a hundred times reverse: memory grown, KiB' "$grown"
check 'nor memory held' at_most 1024 "$grown"
check 'and pictures come in place' in_place_only
check 'the unit was not restarted' test "$(unit_restarts)" = 0
v4l2-ctl -d /dev/video0 -c osd_text_mode=0
open_pin reverse
