#!/bin/sh
# a controller instead of a virtual bus: its driver's error frames, bus off with the carrier gone, pulled out and back
command -v can_controller >/dev/null || skip 'no can_controller here'
stands() { ! grows; }
controller_pid='' commands=/run/controller
# The controller is the interface that the profile names, and the car is on its wire.
controller_plug() {
	rm -f $commands
	mkfifo $commands
	can_controller vcan0 vcan1 <>$commands &
	controller_pid=$!
	within 2 ip link show vcan0 && ip link set vcan0 type can bitrate 500000 && ip link set vcan0 txqueuelen 1000 up
}
controller_pull() {
	kill "$controller_pid"
	wait "$controller_pid" 2>/dev/null
}
controller_says() { echo "$1" >$commands; }
link_state() { ip -details -json link show vcan0 | jq -r '.[0].linkinfo.info_data.state'; }
bus_is() { [ "$(stat_of '.can.interfaces[0].health')" = "$1" ]; }

DRIVE_ON=vcan1
ignition_on
can_delete vcan0
if ! controller_plug; then
	controller_pull
	can_make vcan0
	skip 'no slcan in this kernel'
fi
unit_start
drive_start 20
check 'the car is heard' within 10 grows
check 'the bus is active' within 2 bus_is active
screen controller-good

controller_says e1f
controller_says sw096000
check 'its driver knows of the warning' within 2 test "$(link_state)" = ERROR-WARNING
check 'a warning is known' within 2 bus_is warning
controller_says sp000128
check 'error passive is known' within 2 bus_is passive
check 'the car is heard all the same' within 2 grows
screen controller-passive
controller_says sa000000
check 'active again is known' within 2 bus_is active

controller_says sb000255
check 'bus off is known' within 2 bus_is 'bus off'
check 'its driver is bus off' test "$(link_state)" = BUS-OFF
check 'nothing is heard any more' within 4 stands
seconds 1
screen controller-off
check 'bus off is on the screen' at_least 400 "$(differ controller-good controller-off)"
drive_stop
# What a restart does, which this driver leaves to whoever looks after the bus.
ip link set vcan0 down
ip link set vcan0 up
controller_says sa000000
drive_start 20
check 'the car is heard after a restart' within 4 grows
check 'the bus is active after a restart' within 2 bus_is active

drive_stop
holds 'controller pulled out' controller_pull
check 'a controller that is gone is known' within 2 bus_is down
seconds 1
screen controller-gone
check 'plugged in, it is made' controller_plug
drive_start 20
check 'the car is heard after plugging in' within 4 grows
note 'plugged in to first statistics with new frames, native ms' "$took_ms"
check 'nothing was restarted' test "$(unit_restarts)" = 0
drive_stop
controller_pull
can_make vcan0
