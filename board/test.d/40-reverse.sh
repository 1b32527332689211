#!/bin/sh
# short: the lever's contact brings the camera's picture in time
needs_pins
unit_start
seconds 1
screen ahead
for _ in 1 2 3 4 5; do
	close_pin reverse
	seconds 1
	[ -e "$OUT/reverse.png" ] || screen reverse
	open_pin reverse
	seconds 1
done
screen ahead-again
check 'reverse shows another picture' at_least 25000 "$(differ ahead reverse)"
check 'the camera was shown' at_least 1 "$(stat_of .camera.shown)"
note 'reverse to picture, median ms here' "$(stat_of .camera.edge_to_picture_ms.median)"
edge=$(native "$(stat_of '.camera.edge_to_picture_ms.max | floor')")
note 'reverse to picture, worst of five, native ms' "$edge"
check 'reverse to picture takes 200 ms at most, native' at_most 200 "$edge"
check 'forward shows the map again' at_least 25000 "$(differ reverse ahead-again)"
