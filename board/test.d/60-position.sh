#!/bin/sh
# short: the last position outlives kill -9, a full disk, a clock set back; the ignition goes off and on
kept_in=/var/lib/boulevard
went_on() { unit_log | grep -c 'going on at the last position'; }
goes_on_again() { [ "$(went_on)" -gt "$1" ]; }
kept() { cksum $kept_in/position.? 2>/dev/null; }
kept_anew() { [ -n "$(kept)" ] && [ "$(kept)" != "$1" ]; }
is_dark() { screen position-dark && at_most 2 "$(colours position-dark)"; }
is_lit() { screen position-lit && at_least 50 "$(colours position-lit)"; }

rm -f $kept_in/position.*
unit_start --display kms
drive_start
check 'the position is kept' within 20 kept_anew ''
sleep 20
before=$(kept)
open_pin ignition
check 'ignition off: it is kept at once' within 8 kept_anew "$before"
check 'and the screen is dark' within 4 is_dark
check 'the process stays' unit_running
close_pin ignition
check 'ignition on: the picture is back' within 3 is_lit
note 'ignition on to the picture, ms' "$took_ms"
drive_stop # from here on nothing but the record knows where the car is

times=$(went_on)
kill -9 "$(unit_pid)"
check 'kill -9: it is back' within 20 unit_running
check 'and goes on where it was' within 20 goes_on_again "$times"

times=$(went_on)
unit_stop
date -s '1 year ago' >/dev/null
unit_start --display kms
check 'a clock set back a year: it goes on where it was' within 20 goes_on_again "$times"
unit_stop
date -s '1 year' >/dev/null

cp -p $kept_in/position.? /run/
mount -t tmpfs -o size=64k tmpfs $kept_in
cp -p /run/position.? $kept_in/
chown --reference=$kept_in/position.0 $kept_in 2>/dev/null || chown --reference=$kept_in/position.1 $kept_in
dd if=/dev/zero of=$kept_in/full bs=1k 2>/dev/null || true
before=$(kept) times=$(went_on)
unit_start --display kms
drive_start
sleep 12
check 'a full disk: the picture goes on' unit_running
check 'what was kept is whole' test "$(kept)" = "$before"
drive_stop
unit_stop
rm -f $kept_in/full
unit_start --display kms
check 'and is gone on from' within 20 goes_on_again "$((times + 1))"
unit_stop
umount $kept_in
