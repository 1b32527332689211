#!/bin/sh
# short: a drive on the bus is seen on the screen
unit_start
screen before
drive_start 20
began=$(now_ms)
check 'pictures come' pictures_come
screen driving
check 'the picture is a city, not a plain one' at_least 60 "$(colours driving)"
check 'it shows something else than before the drive' at_least 25000 "$(differ before driving)"
seconds 3
screen later
check 'the car has moved on' at_least 2500 "$(differ driving later)"
check 'the bus was read' at_least 100 "$(stat_of .vehicle.frames_in)"
# Later the log has places without a fix, and begins again: counters jump.
faults=$(stat_of '"\(.vehicle.frames_bad) \(.vehicle.faults)"')
[ $(($(now_ms) - began)) -gt 60000 ] || check 'no frame was bad' test "$faults" = '0 {}'
check 'no frame was lost' test "$(stat_of .can.frames_lost)" = 0
check 'nothing was allocated after the start' test "$(stat_of .memory.allocations_after_start)" = 0
note 'a frame, median ms here' "$(stat_of .frame_ms.median)"
note 'memory at most, MiB' "$(stat_of '.memory.peak_rss_bytes / 1048576 | floor')"
