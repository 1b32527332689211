#!/bin/sh
# 8,000 frames a second for 60 s: none is lost, and what they cost (not arm64)
rate=${LOAD_RATE:-8000} seconds=${LOAD_SECONDS:-60}
command -v can_load >/dev/null || skip 'no can_load'
cpu_ms() { stat_of .can.cpu_ms; }
# What the kernel threw away before any socket: the second number of each processor, in hexadecimal.
thrown_away() { while read -r _ dropped _; do printf '%d\n' "0x$dropped"; done </proc/net/softnet_stat | awk '{ sum += $1 } END { print sum }'; }
run_load() {
	can_load vcan0 "$rate" "$seconds" >"$OUT/load.json" || return 1
	sleep 2
}

# Recorded: every frame of the bus comes up, none is filtered out by the kernel.
recording=/var/lib/boulevard/load.candump
close_pin ignition
unit_start --record $recording --record-limit 200
seconds 5 # the map comes up first
before=$(cpu_ms) thrown=$(thrown_away)
check "the bus carries $((rate * seconds)) frames" run_load
note 'rate reached, frames a second' "$(jq .rate "$OUT/load.json")"
note 'the bus paused because this machine did, ms' "$(jq .paused_ms "$OUT/load.json")"
check 'the rate is reached, but for 1 %' at_least "$((rate * 99 / 100))" "$(jq .rate "$OUT/load.json")"
check 'the kernel lost none before a socket' test "$(thrown_away)" = "$thrown"
check 'the kernel lost none before we read them' test "$(stat_of .can.frames_lost)" = 0
check 'the recording lost none' test "$(stat_of .record.lost)" = 0
note 'CPU of reception, every frame, us a frame in this guest' "$(awk "BEGIN { print ($(cpu_ms) - $before) * 1000 / ($rate * $seconds) }")"
unit_stop
can_load --check $recording >"$OUT/load-check.json"
check 'every number is in the recording, once' jq -e ".numbered == $rate * $seconds and .missing == 0 and .doubled == 0" "$OUT/load-check.json"
rm -f $recording $recording.1

# Not recorded: only the identifiers in use leave the kernel.
unit_start
seconds 5 # the map comes up first
before=$(cpu_ms) seconds=10
check 'the same with the filters of the signals in use' run_load
note 'CPU of reception, filtered, us a frame in this guest' "$(awk "BEGIN { print ($(cpu_ms) - $before) * 1000 / ($rate * $seconds) }")"
