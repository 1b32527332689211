#!/bin/sh
# the clock is set back a year, and forward two
command -v can_load >/dev/null || skip 'no can_load'
ignition_on
unit_start
can_load --play "$DRIVE" vcan0 & # canplayer's pace is the wall clock's
player=$!
heard() { [ "$(stat_of .vehicle.frames_in)" -gt "${1:-0}" ]; }
check 'the car is heard' within 10 heard
seconds 6 # the drive itself has no fix for two of its first five seconds
for step in '1 year ago' '2 years' '1 year ago'; do
	before=$(stat_of .vehicle.frames_in)
	stale_before=$(stat_of .vehicle.stale_ms_max)
	watch_start 4
	sleep 0.5
	date -s "$step" >/dev/null
	check "clock to '$step': the car is heard within 2 s" within 2 heard "$((before + 20))"
	watch_end >/dev/null
	check "clock to '$step': no picture takes 2 s" at_most 2000 "$gap_ms"
	note "longest time without a picture, clock to '$step', native ms" "$gap_ms"
	check "clock to '$step': no signal has become older" at_most "$((stale_before + $(scaled 1000)))" "$(stat_of .vehicle.stale_ms_max)"
done
kill "$player"
screen clock
check 'nothing was restarted' test "$(unit_restarts)" = 0
