#!/bin/sh
# what is pulled while it runs: the process, the map's file, the bus, the disk, the clock
unit_start
drive_start 20
pictures_come
state=/var/lib/boulevard

holds 'kill -9' start sh -c 'kill -KILL "$(systemctl show -P MainPID boulevard)"'
check 'kill -9: it runs again' within 5 start unit_running
check 'kill -9: the last position was kept' sh -c "ls -l $state; [ -n \"\$(find $state -type f -size +0 ! -name stats.json)\" ]"

cp "$CITY" /run/city.blvd
UNIT_CITY=/run/city.blvd unit_start
pictures_come
holds 'map file removed' rm /run/city.blvd
check 'map file removed: the unit was not restarted' unit_running

holds 'interface deleted' can_delete vcan0
check 'interface deleted: it runs on' unit_running
can_make vcan0
drive_start 20
before=$(stat_of .vehicle.frames_in)
heard_again() { at_least "$((before + 50))" "$(stat_of .vehicle.frames_in)"; }
check 'interface made again: the bus is heard' within 5 heard_again

holds 'clock set back a year' date -s '1 year ago' >/dev/null
check 'clock set back a year: it runs on' unit_running
check 'clock set back a year: pictures come' pictures_come
holds 'clock set forward' date -s '13 months' >/dev/null
check 'clock set forward: pictures come' pictures_come

unit_stop
mount -t tmpfs -o size=256k,mode=700 tmpfs $state
chown boulevard:boulevard $state
UNIT_CITY=$CITY unit_start
drive_start 20
pictures_come
kept=$(find $state -type f -size +0 ! -name stats.json | wc -l)
holds 'disk full' sh -c "cat /dev/zero >$state/full 2>/dev/null; true"
check 'disk full: it runs on' unit_running
seconds 3
check 'disk full: nothing kept was lost' at_least "$kept" "$(find $state -type f -size +0 ! -name stats.json ! -name full | wc -l)"
rm $state/full
unit_stop
check 'disk no longer full: the position is kept' sh -c "[ -n \"\$(find $state -type f -size +0 ! -name stats.json)\" ]"
umount $state
