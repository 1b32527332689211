#!/bin/sh
# short: reverse shows the camera, also without a map; a camera that goes is said to be gone
unit_start
seconds 1
screen ahead
close_pin reverse
check 'a picture of the camera is shown' within 3 sh -c "[ \"$(stat_of .camera.shown)\" != 0 ]"
seconds 1
screen reverse
check 'the screen shows it' at_least 50000 "$(differ ahead reverse)"
camera_unplug
seconds 1
screen unplugged
check 'a camera that goes is seen' at_least 20000 "$(differ reverse unplugged)"
check 'pictures still come' pictures_come
camera_plug
seconds 3
screen plugged
check 'one that returns is shown' at_least 20000 "$(differ unplugged plugged)"
open_pin reverse
seconds 1
screen ahead-again
check 'forward shows the map' at_least 50000 "$(differ plugged ahead-again)"
note 'reverse to picture, median ms here' "$(stat_of .camera.edge_to_picture_ms.median)"
edge=$(native "$(stat_of '.camera.edge_to_picture_ms.max | floor')")
note 'reverse to picture, worst, native ms' "$edge"
check 'reverse to picture is 200 ms at most, native' at_most 200 "$edge"
check 'no picture was older than 200 ms, native' at_most 200 "$(native "$(stat_of '.camera.age_max_ms | floor')")"
