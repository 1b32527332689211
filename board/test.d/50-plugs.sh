#!/bin/sh
# what is pulled while it runs: the process, the map's file, the bus, the disk, the clock
unit_start
drive_start 20
pictures_come
state=/var/lib/boulevard
positions() { find $state -name 'position.[01]' -size +0 | wc -l; }

unit_stop
unit_start
check 'a stop keeps the last position' at_least 1 "$(positions)"
holds 'kill -9' start sh -c 'kill -KILL "$(systemctl show -P MainPID boulevard)"'
check 'kill -9: it runs again' within 5 start unit_running
check 'kill -9: the last position is known again' sh -c "journalctl -o cat --no-pager _PID=$(unit_pid) | grep 'going on at the last position'"

cp "$CITY" /run/city.blvd
UNIT_CITY=/run/city.blvd unit_start
pictures_come
holds 'map file removed' rm /run/city.blvd
seconds 3 # streets that were not read before come up meanwhile
check 'map file removed: pictures come' pictures_come
check 'map file removed: the unit was not restarted' test "$(unit_restarts)" = 0
screen map-removed
check 'map file removed: the picture is one of a city' at_least 50 "$(colours map-removed)"

holds 'interface deleted' can_delete vcan0
check 'interface deleted: it runs on' unit_running
can_make vcan0
drive_start 20
before=$(stat_of .vehicle.frames_in)
heard_again() { at_least "$((before + 50))" "$(stat_of .vehicle.frames_in)"; }
check 'interface made again: the bus is heard' within 5 heard_again

holds 'clock set back a year' sh -c "date -s '1 year ago' >/dev/null"
check 'clock set back a year: it runs on' unit_running
check 'clock set back a year: pictures come' pictures_come
holds 'clock set forward' sh -c "date -s '13 months' >/dev/null"
check 'clock set forward: pictures come' pictures_come

# The first disk has room for what the driver keeps of its shaders, the second never had any.
for size in 8m 256k; do
	unit_stop
	mount -t tmpfs -o size=$size,mode=700 tmpfs $state
	chown boulevard:boulevard $state
	check "disk of $size: the unit starts" unit_start
	drive_start 20
	check "disk of $size: pictures come" pictures_come
	unit_stop
	unit_start
	kept=$(positions)
	check "disk of $size: the position is kept" at_least 1 "$kept"
	holds "disk of $size full" sh -c "cat /dev/zero >$state/full 2>/dev/null; true"
	check "disk of $size full: it runs on" unit_running
	if [ -e "$PINS/pin-reverse" ]; then
		holds "disk of $size full, reverse, which needs other shaders" close_pin reverse
		open_pin reverse
	fi
	seconds 3
	check "disk of $size full: it was not restarted" test "$(unit_restarts)" = 0
	check "disk of $size full: nothing kept was lost" at_least "$kept" "$(positions)"
	holds "disk of $size full, kill -9" start sh -c 'kill -KILL "$(systemctl show -P MainPID boulevard)"'
	check "disk of $size full, kill -9: it runs again" within 5 start unit_running
	rm $state/full
	drive_start 40
	seconds 3
	unit_stop
	check "disk of $size no longer full: the position is kept" at_least "$kept" "$(positions)"
	umount $state
done
