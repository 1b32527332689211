#!/bin/sh
# the panel: one modeset, then flips; unplugged and plugged in; killed and back
status=$(ls -d /sys/class/drm/card*-Virtual-1/status 2>/dev/null | head -1)
[ -n "$status" ] || skip 'no virtual panel in this kernel'
counts_at_least() { at_least "$2" "$(stat_of ".display.$1")"; }

check 'the unit shows its picture on the panel' unit_start --display kms
drive_start 20
check 'one modeset' test "$(stat_of .display.modesets)" = 1
check 'pictures flip' within 20 counts_at_least flips 5
note 'display' "$(stat_of .display.detail)"
note 'start, ms of processor time' "$(stat_of .start_ms.cpu)"
screen panel
check 'the picture is one of a city' at_least 50 "$(colours panel)"

echo off >"$status"
check 'unplugged: it is noticed' within 10 counts_at_least hotplugs 1
check 'and the unit lives' unit_running
echo detect >"$status"
check 'plugged in: a new modeset' within 10 counts_at_least modesets 2
note 'panel back to modeset, ms' "$took_ms"
flips=$(stat_of .display.flips)
check 'and pictures flip again' within 20 counts_at_least flips $((flips + 3))

kill -9 "$(unit_pid)"
began=$(now_ms)
check 'killed: it is back' within 30 test "$(systemctl is-active boulevard)" = active
check 'and flips' within 30 counts_at_least flips 1
note 'kill to picture, ms' $(($(now_ms) - began))
screen after-kill
check 'the picture is there again' at_least 50 "$(colours after-kill)"
