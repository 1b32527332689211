#!/bin/sh
# terminals: away and back, with another program on the screen, in reverse, killed, stopped; on one, on none, by hand (not arm64)
[ -c /dev/tty7 ] || skip 'no terminals in this kernel'
needs_panel

drop_in=/run/systemd/system/boulevard.service.d/terminal.conf
to() { board_neighbour to "$1"; }
in_front() { [ "$(board_neighbour active)" = "$1" ]; }
terminal_is() { [ "$(board_neighbour terminal "$1")" = "$2" ]; }
colour_at_corner() { board_screen pixel "$OUT/$1.png" 5 5; }
# paint COLOUR: another program takes the screen, and keeps it until paint_end; fails where it does not get it.
paint() {
	rm -f /run/paint
	board_neighbour paint "$1" >/run/paint 2>&1 &
	painter=$!
	within 5 test -s /run/paint
	grep -q painted /run/paint
}
paint_end() {
	kill $painter
	wait $painter 2>/dev/null
}
# cpu_of PID: ms of processor time so far.
cpu_of() { sed 's/.*) //' "/proc/$1/stat" | awk '{ print ($12 + $13) * 10 }'; }
is_dark() {
	screen "$1" && [ "$(colours "$1")" = 1 ] && [ "$(colour_at_corner "$1")" = 000000 ]
}
# a_city NAME: the screen shows one.
a_city() {
	screen "$1" && at_least 50 "$(colours "$1")"
}
flips_again() { within 4 "$@" pictures_come; }
# three_seconds: $cpu is the processor time that they took, $flips how many pictures came.
three_seconds() {
	flips=$(stat_of .display.flips) cpu=$(cpu_of "$(unit_pid)")
	seconds 3
	cpu=$(($(cpu_of "$(unit_pid)") - cpu)) flips=$(($(stat_of .display.flips) - flips))
}

# --- on a terminal of its own
mkdir -p "${drop_in%/*}"
cp /usr/share/doc/boulevard/examples/terminal.conf $drop_in
to 1
check 'with a terminal: the unit starts' unit_start
check 'its terminal comes to the front' within 2 in_front 7
check 'the terminal shows no text and waits for the program' terminal_is 7 'graphics process'
drive_start 20
check 'pictures flip' flips_again
check 'and nobody else gets the screen' sh -c '! board_neighbour paint 204060'
press zoom-in
seconds 1
zoom=$(stat_of .controls.zoom)

three_seconds
cpu_in_front=$cpu
check 'another terminal comes to the front' to 2
seconds 0.3
check 'the screen is black: no picture stands that could be taken for a live one' is_dark vt-away
check 'another program gets the screen' paint 204060
screen vt-other
check 'its picture is what is seen' test "$(colour_at_corner vt-other)" = 204060
heard=$(stat_of .vehicle.frames_in)
three_seconds
check 'away: drawing rests' test "$flips" = 0
note 'in front and away, processor time in three seconds, ms here' "$cpu_in_front, $cpu"
check 'away: it uses hardly any processor time' at_most $((cpu_in_front / 4)) "$cpu"
check 'away: the bus is heard' at_least $((heard + 50)) "$(stat_of .vehicle.frames_in)"
seconds 3
check 'away: the watchdog does not bite' test "$(unit_restarts)" = 0

modesets=$(stat_of .display.modesets)
paint_end
back=$(now_ms)
check 'back: our terminal comes to the front' to 7
check 'back: a modeset' within 2 counts_at_least modesets $((modesets + 1))
note 'back to modeset, with the asking, native ms' "$(native $(($(now_ms) - back)))"
check 'back: pictures flip' flips_again
check 'back: the city is shown' a_city vt-back
check 'back: the zoom is kept' test "$(stat_of .controls.zoom)" = "$zoom"
check 'two switches are no restart' test "$(unit_restarts)" = 0

# A program that does not let go at once is waited for.
to 2
paint 602040
to 7
seconds 1
screen vt-late
check 'back, but the screen is taken: it is the other picture' test "$(colour_at_corner vt-late)" = 602040
paint_end
check 'let go: pictures flip' flips_again

drive_stop
seconds 8
screen vt-stands
to 2
seconds 2
to 7
check 'standing: pictures flip after a switch' flips_again
screen vt-stands-again
check 'standing: the same place is shown' at_most 25000 "$(differ vt-stands vt-stands-again)"
count=0
while [ $count -lt 20 ]; do
	to 2 && to 7 || break
	count=$((count + 1))
done
check 'twenty quick switches' test $count = 20
check 'and pictures flip' flips_again
drive_start 20

# --- in reverse
if [ -e "$PINS/pin-reverse" ]; then
	shown() { [ "$(stat_of .camera.shown)" -gt "$1" ]; }
	close_pin reverse
	check 'reverse: the camera is shown' within 3 shown 0
	screen vt-reverse
	to 2
	seconds 0.3
	check 'reverse, away: the picture does not stand' is_dark vt-reverse-away
	seconds 2
	before=$(stat_of .camera.shown)
	to 7
	check 'reverse, back: the camera is shown' within 3 shown "$before"
	seconds 0.5
	screen vt-reverse-back
	check 'reverse, back: it is what is seen' at_least 25000 "$(differ vt-stands vt-reverse-back)"
	to 2
	open_pin reverse
	seconds 1
	to 7
	flips_again
	a_city vt-forward
	check 'reverse left while away: the map is shown' at_least 25000 "$(differ vt-reverse vt-forward)"
	to 2
	close_pin reverse
	seconds 1
	before=$(stat_of .camera.shown)
	to 7
	check 'reverse put in while away: the camera is shown' within 3 shown "$before"
	open_pin reverse
fi

# --- killed
killed=$(unit_pid)
kill -9 "$killed"
check 'killed in front: it runs again' within 2 start runs_anew
check 'killed in front: pictures flip' flips_again
check 'killed in front: it stands on its terminal' terminal_is 7 'graphics process'
to 2
check 'killed in front: the next one lets the screen go' paint 406020
killed=$(unit_pid)
kill -9 "$killed"
check 'killed while away: it runs again' within 2 start runs_anew
seconds 1
check 'killed while away: the other terminal stays in front' in_front 2
screen vt-killed-away
check 'killed while away: and the other picture' test "$(colour_at_corner vt-killed-away)" = 406020
check 'killed while away: the unit is alive' unit_running
paint_end
to 7
check 'killed while away: back, pictures flip' flips_again start
check 'killed while away: the city is shown' a_city vt-after-kill

# --- ended
to 2
seconds 0.5
unit_stop
check 'stopped while away: it ended by itself' test "$(systemctl show -P Result boulevard)" = success
check 'stopped while away: its terminal shows text again' terminal_is 7 'text auto'
check 'stopped while away: the other terminal stays in front' in_front 2
to 7
check 'stopped while away: its terminal can be looked at' in_front 7
check 'a start in front' unit_start
check 'pictures flip again' flips_again
unit_stop
check 'stopped in front: the terminal shows text again' terminal_is 7 'text auto'

# --- while another program has the screen
to 2
paint 808080
unit_start
to 7
seconds 1
check 'started while the screen is taken: the unit waits' unit_running
paint_end
check 'and comes when it is free' flips_again start
check 'with the city' a_city vt-waited

# --- on no terminal, as it is installed
rm $drop_in
to 1
check 'without a terminal: the unit starts' unit_start
check 'without a terminal: pictures flip' flips_again
check 'without a terminal: nobody stands on the first' terminal_is 1 'text auto'
to 2
check 'without a terminal: a switch changes nothing' flips_again
check 'without a terminal: the city is shown' a_city vt-none
check 'without a terminal: nobody else gets the screen' sh -c '! board_neighbour paint 204060'
to 1
unit_stop
paint 808080
unit_start
seconds 1
check 'without a terminal, the screen taken: the unit waits' unit_running
paint_end
check 'and has it when it is free' flips_again start
unit_stop

# --- by hand, as root on the first terminal
to 1
sh -c 'exec setsid boulevard "$CITY" --profile /usr/share/boulevard/profiles/emulator.ini --display kms --can vcan0 --stats /run/hand.json </dev/tty1 >/run/hand.log 2>&1' &
hand=$!
hand_says() {
	kill -USR1 $hand
	sleep 0.3
	jq -r "$1" /run/hand.json
}
check 'by hand: it stands on the terminal' within 20 start terminal_is 1 'graphics process'
flipped() { at_least "$1" "$(hand_says .display.flips)"; }
check 'by hand: pictures flip' within 20 start flipped 3
to 2
check 'by hand: another program gets the screen' paint 208020
paint_end
to 1
flips=$(hand_says .display.flips)
check 'by hand: back, pictures flip' within 4 flipped $((flips + 3))
kill $hand
wait $hand
check 'by hand: ended as asked' test $? = 0
check 'by hand: the terminal shows text again' terminal_is 1 'text auto'
