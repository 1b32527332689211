#!/bin/sh
# blvd sim and boulevard together, as a new user starts them: one command, or two; driven by words; and what outlives kill -9. Arguments:
# build folder, source folder.
set -eu
build=$1
blvd=$build/tools/blvd
boulevard=$build/board/boulevard
dir=$(mktemp -d)
# shellcheck disable=SC2046 # a list of numbers
trap 'kill $(cat "$dir"/*.pid 2>/dev/null) 2>/dev/null || true; rm -rf "$dir"' EXIT
cd "$dir"

fail() {
	echo "$@" >&2
	exit 1
}
# until_true SECONDS COMMAND...
until_true() {
	left=$(($1 * 10))
	shift
	until "$@" >/dev/null 2>&1; do
		left=$((left - 1))
		[ $left -gt 0 ] || return 1
		sleep 0.1
	done
}

"$blvd" bake -q "$2/tests/tools/data/crossing.osm" -o city.blvd

# One command. A fault ends in the statistics as a signal that was stale; the child's end is the simulation's; its pipes are gone.
before=$(find /tmp -maxdepth 1 -name 'blvd-sim-*' | wc -l)
printf 'speed 30\nlost:speed\nlost:wheels\nlost:nonsense\n' | "$blvd" sim city.blvd --run --hand -- \
	--headless --size 160x90 --fps 5 --limit 15 --stats one.json >one.log 2>&1 || fail "$(cat one.log)"
jq -e '.vehicle.frames_in > 100' one.json >/dev/null || fail "$(cat one.json one.log)"
grep -q "lost:nonsense: no message or signal 'nonsense'" one.log || fail 'a wrong command was not told'
[ "$(find /tmp -maxdepth 1 -name 'blvd-sim-*' | wc -l)" -le "$before" ] || fail 'the pipes of the child are left'

# Two commands, and a state folder. The car drives, boulevard is killed, comes back, and goes on without any fix.
"$blvd" sim city.blvd --can "unix:$dir/car" --hand --control "$dir/say" </dev/null 2>sim.log &
echo $! >sim.pid
"$boulevard" city.blvd --can "unix:$dir/car" --headless --size 160x90 --fps 5 --state "$dir/state" 2>two.log &
echo $! >two.pid
until_true 60 test -s state/position.0 || fail "nothing was kept: $(cat sim.log two.log)"
echo speed 50 >say
sleep 6
echo stop >say
until_true 60 test -s state/position.1 || fail "the stop was not kept: $(cat sim.log two.log)"
cp -r state kept
kill -9 "$(cat two.pid)"
wait "$(cat two.pid)" 2>/dev/null || true
echo quit >say
wait "$(cat sim.pid)" || fail "$(cat sim.log)"
rm sim.pid two.pid
"$boulevard" city.blvd --can "unix:$dir/car" --headless --size 160x90 --fps 5 --state "$dir/state" --limit 3 2>three.log || fail "$(cat three.log)"
grep -q 'going on at the last position' three.log || fail "$(cat three.log)"

# A replay does not read it.
"$blvd" drive city.blvd --seed 4 --minutes 0.3 -o log.candump 2>/dev/null
STATE_DIRECTORY=$dir/state "$boulevard" city.blvd --replay log.candump --headless --size 160x90 --fps 5 --limit 3 2>four.log
if grep -q 'last position' four.log; then
	fail 'a replay depends on the last run'
fi

# Wrong usage and bad input: one line, and the right status.
status() {
	wanted=$1
	shift
	got=0
	"$@" </dev/null >wrong.log 2>&1 || got=$?
	[ $got -eq "$wanted" ] || fail "$*: status $got, not $wanted: $(cat wrong.log)"
}
status 2 "$blvd" sim city.blvd
status 2 "$blvd" sim --can vcan0
status 2 "$blvd" sim city.blvd --can unix:x --via nowhere
status 2 "$blvd" sim city.blvd --can unix:x --fault 3:melt
status 3 "$blvd" sim two.log --can unix:x
status 3 "$blvd" sim city.blvd --can "unix:$dir/x" --gpio "$dir/nothing"
status 3 "$boulevard" city.blvd --replay log.candump --headless --gnss "$dir/nothing"
