#!/bin/sh
# the bus goes and comes back: bus off, down, deleted and made again
ignition_on
unit_start
drive_start 20
check 'the car is heard' within 10 grows
screen bus-good

# What a controller says of itself; a virtual one is told to say it.
drive_stop
cansend vcan0 20000040#0000000000000000
seconds 2
screen bus-off
check 'bus off is on the screen' at_least 400 "$(differ bus-good bus-off)"
drive_start 20
check 'and gone when frames come again' within 2 grows

ip link set vcan0 down
seconds 2.5
screen bus-down
check 'the picture stays while the interface is down' unit_running
ip link set vcan0 up
drive_start 20
check 'the car is heard again after down and up' within 2 grows
note 'up to first statistics with new frames, native ms' "$took_ms"

can_delete vcan0
seconds 1
watch_start 3
watch_end >/dev/null
check 'the picture goes on without the interface' at_most 2000 "$gap_ms"
screen bus-deleted
can_make vcan0
drive_start 20
check 'the car is heard again after deleting and making it' within 2 grows
note 'made again to first statistics with new frames, native ms' "$took_ms"
seconds 1
screen bus-again
check 'nothing was restarted' test "$(unit_restarts)" = 0
check 'no frame was lost that the kernel had' test "$(stat_of .can.frames_lost)" = 0
