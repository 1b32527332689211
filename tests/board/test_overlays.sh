#!/bin/sh
# The device-tree overlays compile, and their pins are those of the profiles.
#   tests/board/test_overlays.sh BUILD SOURCE
set -eu
cd "$2"
command -v dtc >/dev/null || exit 77
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
	echo "$*" >&2
	exit 1
}
for overlay in board/dts/*.dtso; do
	dtc -q -@ -I dts -O dtb -o "$work/overlay.dtbo" "$overlay" || fail "$overlay does not compile"
done

# The tables of the Verdin modules: | GPIO_1 | 206 | MCU_GPIO0 1 | reverse |, and which controller has which address.
line_of() { # PROFILE KEY
	sed -n "/^\[gpio\]/,/^\[/s/^$2 *= *\([^ ]*\).*/\1/p" "board/profiles/$1.ini"
}
same() { # OVERLAY PROFILE ADDRESS=NAME...
	overlay=board/dts/boulevard-verdin-$1.dtso profile=$2
	shift 2
	rows=0
	while IFS='|' read -r line what; do
		case $what in
		'knob, a') key=rotary_a ;;
		'knob, b') key=rotary_b ;;
		lamps) key=night ;;
		*) key=$what ;;
		esac
		wanted=''
		for chip in "$@"; do
			[ "${chip#*=}" != "${line% *}" ] || wanted=${chip%%=*}.gpio:${line#* }
		done
		[ "$(line_of "$profile" "$key")" = "$wanted" ] || fail "$overlay: $key is $line, in $profile.ini $(line_of "$profile" "$key")"
		rows=$((rows + 1))
	done <<-END
		$(sed -n 's/^ \* | GPIO_[0-9] | [0-9]* | \(.*\) | \(.*\) |$/\1|\2/p' "$overlay")
	END
	[ $rows = 8 ] || fail "$overlay: $rows pins"
}
same imx8mp imx8m 30200000=GPIO1 30230000=GPIO4
same am62 am62x 4201000=MCU_GPIO0 600000=GPIO0
