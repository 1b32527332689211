#!/bin/sh
# knob, buttons and lines: the menu, a line in use elsewhere, a chip that goes and comes back, an input device
needs_pins

says() { [ "$(stat_of ".controls.$1")" = "$2" ]; }

# What the unit tests cannot have without a kernel: each says itself what it checked.
for name in platform_test_gpio_libgpiod platform_test_evdev; do
	[ ! -x "$TESTS/$name" ] || check "$name on this kernel" "$TESTS/$name"
done
chip_find

close_pin ignition
unit_start --display kms
drive_start 20
check 'all lines are there' within 30 says fault null
note 'levels read at the start' "$(stat_of .controls.resyncs)"

# The knob: four edges a detent; the simulated chip tells of edges at the guest's ticks, so it is turned slowly here.
before=$(stat_of .controls.zoom)
turn right 3
turn left 1
check 'two detents zoom by two' within 3 says "zoom / $before * 1000 | round" 1254
press view
check 'the view button changes the camera' within 3 says view chase

screen menu-closed
press rotary-push
check 'a push opens the menu' within 3 says menu true
seconds 0.5
screen menu-open
press rotary-push
turn right 1
press rotary-push
check 'in it the knob chooses the view' within 3 says view heading-up
press rotary-push 1000
check 'a long push closes it' within 3 says menu false
check 'it was seen' at_least 6400 "$(differ menu-closed menu-open)" # now: the menu does not wait for a slow machine
press rotary-push
check 'and so does time' within 25 says menu false

# Twenty fast closings of one contact, closer than its debounce time.
actions=$(stat_of .controls.actions)
for _ in 1 2 3 4 5 6 7 8 9 10; do
	close_pin back
	open_pin back
done
sleep 0.3
check 'a contact that bounces presses at most once' at_most 1 "$(($(stat_of .controls.actions) - actions))"

# A second program finds the lines taken, draws all the same, and says so.
XDG_CACHE_HOME=/run/speed-cache boulevard "$CITY" --profile /usr/share/boulevard/profiles/emulator.ini --can vcan0 --headless --size 160x96 --limit 5 \
	--stats "$OUT/busy.json" 2>"$OUT/busy.log"
check 'lines in use elsewhere are a state' test "$(jq -r .controls.fault "$OUT/busy.json")" = 'Reverse line in use elsewhere'
check 'and are named in the log' grep -q 'gpio reverse (car-pins line 0): in use elsewhere' "$OUT/busy.log"

watch_start 8
chip_unplug
check 'a chip that goes away is told' within 3 says fault 'Reverse line lost'
note 'chip gone to told, ms' "$took_ms"
seconds 1
screen chip-gone
chip_plug
close_pin ignition
check 'and is there again when it comes back' within 3 says fault null
note 'chip back to in use, ms' "$took_ms"
note 'longest time without a new picture meanwhile, ms' "$(watch_end)"
check 'the process never stopped' test "$(unit_restarts)" = 0
