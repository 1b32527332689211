#!/bin/sh
# the panel: one modeset, then flips; unplugged and plugged in, told by the kernel or asked; killed and back
needs_panel
panel() { echo "$1" >"$panel_folder/status"; } # off, or detect: it is there
# A driver with a real plug tells of it; this one has none, so its card is made to.
panel_tells() { echo change >"${panel_folder%-Virtual-1}/uevent"; }

# comes_and_goes HOW TELL: unplugged and plugged in, where TELL is what is done for the unit to know.
comes_and_goes() {
	before=$(stat_of .display.hotplugs)
	panel off
	$2
	check "unplugged, $1: it is noticed within 4 s" within 4 counts_at_least hotplugs $((before + 1))
	check "unplugged, $1: the unit lives" unit_running
	before=$(stat_of .display.modesets)
	panel detect
	$2
	check "plugged in, $1: a new modeset within 4 s" within 4 counts_at_least modesets $((before + 1))
	note "plugged in, $1, to modeset known, with the asking, native ms" "$took_ms"
	before=$(stat_of .display.flips)
	check "plugged in, $1: pictures flip again" within 2 counts_at_least flips $((before + 3))
}

check 'the unit shows its picture on the panel' unit_start --display kms
drive_start 20
check 'one modeset' test "$(stat_of .display.modesets)" = 1
check 'pictures flip' within 2 counts_at_least flips 5
note 'display' "$(stat_of .display.detail)"
note 'start, ms of processor time' "$(stat_of .start_ms.cpu)"
screen panel
check 'the picture is one of a city' at_least 50 "$(colours panel)"

comes_and_goes 'told' panel_tells
screen panel-again
check 'plugged in: the picture is one of a city' at_least 50 "$(colours panel-again)"
check 'the unit was not restarted' test "$(unit_restarts)" = 0

killed=$(unit_pid)
holds 'killed' start kill -9 "$killed"
check 'killed: it runs again' within 2 start runs_anew
check 'killed: pictures flip' within 2 counts_at_least flips 5
screen after-kill
check 'the picture is there again' at_least 50 "$(colours after-kill)"

# Without the kernel's messages, the panel is asked.
deaf=/run/systemd/system/boulevard.service.d/deaf.conf
printf '[Service]\nRestrictAddressFamilies=\nRestrictAddressFamilies=AF_CAN AF_UNIX\n' >$deaf
check 'without netlink: it starts' unit_start --display kms
comes_and_goes 'asked' true
rm $deaf
