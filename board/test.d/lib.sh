# What a scene of board/test may use (board/README.md, "Scenes"). Sourced by run; POSIX sh, as root in the guest.
#   $OUT         folder for pictures and logs that stay
#   $CITY $DRIVE a small city and a drive in it (candump log, interface vcan0)
#   $PINS        folder with a file a pin: echo pull-down >$PINS/pin-reverse closes its switch

# check NAME COMMAND...: one line, "ok" or "FAILED" with what the command said. Returns what the command returned.
check() {
	check_name=$1
	shift
	if "$@" >/run/check-said 2>&1; then # no subshell: what the command sets stays
		echo "  ok      $check_name"
	else
		echo "  FAILED  $check_name: $*"
		tail -20 /run/check-said | sed 's/^/          /'
		echo failed >>"$SCENE_FAULTS"
		return 1
	fi
}

# note NAME VALUE: a figure for the report.
note() {
	echo "  figure  $1: $2"
	echo "$SCENE $1: $2" >>"$OUT/figures"
}

# skip WHY: ends the scene as not done here.
skip() {
	echo "  skipped $1"
	exit 77
}

# needs_pins: ends a scene that turns switches where the kernel has no simulated ones.
needs_pins() { [ -e "$PINS/pin-reverse" ] || skip 'no pins in this kernel'; }
# needs_panel: the same without a virtual panel; $panel_folder is the kernel's of it.
needs_panel() {
	panel_folder=$(ls -d /sys/class/drm/card*-Virtual-1 2>/dev/null | head -1)
	[ -n "$panel_folder" ] || skip 'no virtual panel in this kernel'
}

# In this guest a frame takes $SLOW times as long as outside, and a start $SLOW_START times (run measures both), so a
# limit that is meant for a board is given in native time: scaled MS is that time here, native MS the other way. With
# "start" behind, the time is that of something that starts the unit; with "pace", of something that is seen in how
# pictures follow each other: they need not come faster than the profile asks for ($PACE, which is less than $SLOW).
scaled() { awk "BEGIN { printf \"%d\", $1 * $(factor "${2:-}") }"; }
native() { awk "BEGIN { printf \"%d\", $1 / $(factor "${2:-}") }"; }
factor() {
	case ${1:-} in
	start) echo "$SLOW_START" ;;
	pace) echo "$PACE" ;;
	*) echo "$SLOW" ;;
	esac
}

# within SECONDS [start] COMMAND...: tries until it succeeds, for so long in native time; $took_ms says how many ms it
# took.
within() {
	within_kind=''
	[ "$2" != start ] || within_kind=start
	within_began=$(now_ms)
	within_end=$((within_began + $(scaled "${1}000" $within_kind)))
	shift
	[ -z "$within_kind" ] || shift
	while ! "$@" >/dev/null 2>&1; do
		took_ms=$(native $(($(now_ms) - within_began)) $within_kind)
		[ "$(now_ms)" -lt "$within_end" ] || return 1
		sleep 0.02
	done
	took_ms=$(native $(($(now_ms) - within_began)) $within_kind)
}

# Uptime, which no change of the clock moves.
now_ms() {
	read -r uptime _ </proc/uptime
	echo "${uptime%.*}${uptime#*.}0"
}

# at_most LIMIT VALUE, at_least LIMIT VALUE: whole numbers or decimals.
at_most() { awk "BEGIN { exit !($2 <= $1) }" || { echo "$2 is more than $1"; return 1; }; }
at_least() { awk "BEGIN { exit !($2 >= $1) }" || { echo "$2 is less than $1"; return 1; }; }

# --- the installed unit -------------------------------------------------------------------------------------------
# unit_start [OPTION...]: (re)starts boulevard.service on the screen and the bus with $CITY, and these options more;
# returns when it is ready. UNIT_CITY and UNIT_PROFILE name others, UNIT_ENVIRONMENT has lines of NAME=VALUE.
unit_start() {
	mkdir -p /etc/boulevard
	{
		echo "BOULEVARD_CITY=${UNIT_CITY-$CITY}"
		echo "BOULEVARD_PROFILE=${UNIT_PROFILE:-/usr/share/boulevard/profiles/emulator.ini}"
		echo "BOULEVARD_OPTIONS=\"--display kms --can vcan0 --stats /var/lib/boulevard/stats.json $*\""
		env | grep -E '^(LP_NUM_THREADS|MALLOC_[A-Z_]*)='
		echo "${UNIT_ENVIRONMENT:-}"
	} >/etc/boulevard/boulevard.conf
	mkdir -p /run/systemd/system/boulevard.service.d
	cat >/run/systemd/system/boulevard.service.d/emulator.conf <<-END
		[Service]
		TimeoutStartSec=$(scaled 20000 start)ms
		WatchdogSec=$(scaled 2000 start)ms
		TimeoutStopSec=$(scaled 2000 start)ms
	END
	systemctl daemon-reload
	systemctl reset-failed boulevard 2>/dev/null
	systemctl restart boulevard
}
unit_stop() { systemctl stop boulevard; }
unit_pid() { systemctl show -P MainPID boulevard; }
unit_running() { [ "$(unit_pid)" != 0 ] && [ "$(systemctl is-active boulevard)" = active ]; }
unit_restarts() { systemctl show -P NRestarts boulevard; }
unit_log() { journalctl -u boulevard --no-pager -o cat "$@"; }

# stat_of FILTER: a figure of the running unit's statistics, as jq says it.
stat_of() {
	rm -f /var/lib/boulevard/stats.json
	systemctl kill -s USR1 boulevard
	within 5 test -s /var/lib/boulevard/stats.json || { echo 'no statistics in 5 s' >&2; return 1; }
	sleep 0.1
	jq -r "$1" /var/lib/boulevard/stats.json
}

# counts_at_least FIGURE VALUE: of the display.
counts_at_least() { at_least "$2" "$(stat_of ".display.$1")"; }
camera_state() { stat_of ".camera.$1"; }
more_than() { [ "$(camera_state "$1")" -gt "$2" ]; } # FIGURE VALUE, of the camera
# shows_picture: whether the camera's are shown, one after the other.
shows_picture() {
	before=$(camera_state shown)
	seconds 0.4
	more_than shown "$before"
}
frames() { stat_of .vehicle.frames_in; }
# grows: whether the car is heard: more frames of it a moment later.
grows() {
	grows_before=$(frames) || return 1
	sleep 0.3
	[ "$(frames)" -gt "$grows_before" ]
}
# runs_anew: whether the unit runs, and not as the process $killed.
runs_anew() { unit_running && [ "$(unit_pid)" != "$killed" ]; }

# --- the car ------------------------------------------------------------------------------------------------------
drive_pid=''
# drive_start [SECONDS]: the drive goes over vcan0, or $DRIVE_ON, again and again; from SECONDS into it.
drive_start() {
	drive_stop
	log=$DRIVE
	if [ -n "${1:-}" ]; then
		log=/run/drive-from.candump
		awk -v from="$1" '{ t = substr($1, 2) + 0 } NR == 1 { first = t } t >= first + from' "$DRIVE" >$log
	fi
	canplayer -l i -I "$log" "${DRIVE_ON:-vcan0}=vcan0" >/dev/null 2>&1 &
	drive_pid=$!
}
drive_stop() {
	[ -z "$drive_pid" ] || kill "$drive_pid" 2>/dev/null || true
	[ -z "$drive_pid" ] || wait "$drive_pid" 2>/dev/null || true
	drive_pid=''
}

# close_pin NAME, open_pin NAME: a switch to ground; press NAME [MS]: both. ignition_on: where there are pins.
close_pin() { echo pull-down >"$PINS/pin-$1"; }
open_pin() { echo pull-up >"$PINS/pin-$1"; }
ignition_on() { [ ! -e "$PINS/pin-ignition" ] || close_pin ignition; }
press() {
	close_pin "$1"
	sleep "$(awk "BEGIN { print ${2:-80} / 1000 }")"
	open_pin "$1"
	sleep 0.06
}
# turn right|left [DETENTS]: the rotary encoder, four edges a detent. The simulated chip tells of edges at the guest's
# ticks, 100 a second: closer ones would become one.
turn() {
	first=rotary-a second=rotary-b
	[ "$1" = right ] || first=rotary-b second=rotary-a
	count=${2:-1}
	while [ "$count" -gt 0 ]; do
		for edge in "close_pin $first" "close_pin $second" "open_pin $first" "open_pin $second"; do
			$edge
			sleep 0.025
		done
		count=$((count - 1))
	done
}

# chip_unplug, chip_plug: the GPIO chip with all its lines. Made anew it may have another number, and its pins are closed
# until they are opened here.
chip_unplug() { echo 0 >/sys/kernel/config/gpio-sim/car/live; }
chip_plug() {
	echo 1 >/sys/kernel/config/gpio-sim/car/live
	chip_find
	for pin in "$PINS"/pin-*; do echo pull-up >"$pin"; done
}
# Where the chip's pins are now, after somebody took it away and brought it back.
chip_find() {
	chip_name=$(cat /sys/kernel/config/gpio-sim/car/pins/chip_name)
	chip_folder=/sys/devices/platform/$(cat /sys/kernel/config/gpio-sim/car/dev_name)/$chip_name
	for pin in "$PINS"/pin-*; do
		line=$(readlink "$pin")
		line=${line%/pull}
		ln -sfn "$chip_folder/${line##*/}/pull" "$pin"
	done
	chgrp gpio "/dev/$chip_name" 2>/dev/null && chmod 660 "/dev/$chip_name"
}
camera_unplug() { echo vivid.0 >/sys/bus/platform/drivers/vivid/unbind; }
camera_plug() { echo vivid.0 >/sys/bus/platform/drivers/vivid/bind; }
can_delete() { ip link del "$1"; }
can_make() { ip link add dev "$1" type vcan && ip link set "$1" mtu 72 txqueuelen 10000 up; }

# --- the screen ---------------------------------------------------------------------------------------------------
# screen NAME: what is scanned out now, as $OUT/NAME.png
screen() { board_screen shot "$OUT/$1.png"; }
# colours NAME: how many different colours that picture has: a plain one has few.
colours() { board_screen colours "$OUT/$1.png"; }
# differ NAME NAME: how many of a million pixels of two pictures differ clearly.
differ() { board_screen differ "$OUT/$1.png" "$OUT/$2.png"; }
# watch_start SECONDS [start], then watch_end [start]: the longest time without a new picture in so many seconds, native
# ms, is printed and in $gap_ms.
watch_start() {
	watch_s=$(awk "BEGIN { print $1 * $(factor "${2:-pace}") }")
	rm -f /run/watch.json
	{
		board_screen watch "$watch_s" >/run/watch.part
		mv /run/watch.part /run/watch.json
	} &
	sleep 0.2
}
watch_end() {
	until [ -e /run/watch.json ]; do # and not while its process lives: a subshell would see it dead and not yet waited for
		sleep 0.02
	done
	gap_ms=$(native "$(jq -r .longest_gap_ms /run/watch.json)" "${1:-pace}")
	echo "$gap_ms"
}

# seconds N: sleeps so long that as many pictures come as in so many seconds of native time.
seconds() { sleep "$(awk "BEGIN { print $1 * $PACE }")"; }

# pictures_come: whether the screen shows at least three new pictures in two seconds.
pictures_come() { [ "$(board_screen watch "$(awk "BEGIN { print 2 * $PACE }")" | jq .pictures)" -ge 3 ]; }

# holds WHAT [start] COMMAND...: does something to the running unit and checks that the picture stays, or returns within
# 2 s of native time; "start" where the unit has to start for that.
holds() {
	holds_what=$1 holds_kind=pace
	shift
	if [ "$1" = start ]; then
		holds_kind=start
		shift
	fi
	watch_start 3 $holds_kind
	"$@"
	watch_end $holds_kind >/dev/null
	note "$holds_what: longest time without a new picture, native ms" "$gap_ms"
	check "$holds_what: the picture stays or returns within 2 s" at_most 2000 "$gap_ms"
}
