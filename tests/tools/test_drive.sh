# blvd drive and blvd track on real cities: the same bytes twice, a drive that a car could do, and the navigator on the
# right street all the time without satellites. Arguments: build folder, source folder.
set -e
blvd=$1/tools/blvd
data=${BLVD_DATA:-$2/../shared/data}
if [ ! -d "$data" ]; then
	echo "skipped: no BLVD_DATA"
	exit 77
fi
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT

fail() {
	echo "$@" >&2
	exit 1
}

# Largest yaw rate, speed step and jump of the place in a truth file.
plausible() {
	awk -F, 'NR > 2 {
		dt = $1 - t; d = $5 - h; if (d > 180) d -= 360; if (d < -180) d += 360
		rate = d / dt; if (rate < 0) rate = -rate; if (rate > yaw) yaw = rate
		a = ($6 - v) / dt; if (a < 0) a = -a; if (a > acc) acc = a
		m = sqrt(($2 - e) ^ 2 + ($3 - n) ^ 2) - 0.5 * ($6 + v) * dt; if (m < 0) m = -m; if (m > jump) jump = m
	} { t = $1; e = $2; n = $3; h = $5; v = $6 }
	END { printf "yaw %.1f deg/s, acceleration %.1f m/s2, jump %.3f m\n", yaw, acc, jump
		exit !(yaw < 60 && acc < 6 && jump < 0.1) }' "$1"
}

city() {
	name=$1
	file=$2
	shift 2
	[ -f "$file" ] || return 0
	"$blvd" bake "$file" -o "$dir/$name.blvd" >"$dir/bake" 2>&1 || fail "$(cat "$dir/bake")"
	for seed in "$@"; do
		"$blvd" drive "$dir/$name.blvd" --seed "$seed" -o "$dir/a" --truth "$dir/truth" || fail "$name $seed: no drive"
		plausible "$dir/truth" || fail "$name $seed: not a car's drive"
		"$blvd" track "$dir/a" --city "$dir/$name.blvd" --truth "$dir/truth" >"$dir/result"
		right=$(sed -n 's/.*"right":\([0-9.]*\).*/\1/p' "$dir/result")
		[ "$right" = 1.00000 ] || fail "$name $seed: on the right street $right of the time: $(cat "$dir/result")"
		grep -q '"frames_bad":0' "$dir/result" || fail "$name $seed: bad frames"
		grep -q '"reroutes":0' "$dir/result" || fail "$name $seed: the route was lost"
	done
	"$blvd" drive "$dir/$name.blvd" --seed "$1" -o "$dir/b"
	"$blvd" drive "$dir/$name.blvd" --seed "$1" -o "$dir/c"
	cmp "$dir/b" "$dir/c" || fail "$name: not the same twice"
}

city rome "$data/city/tiny/rome-piazza-vittorio.osm.pbf" 1 2 3 5
city geneva "$data/city/geneva/geneva.osm.pbf" 1 3
city sf "$data/city/sf-downtown/sf-downtown.osm.pbf" 1 2
city monaco "$data/city/monaco/monaco-2023-tilemaker.osm.pbf" 1 2

# stops in order, a start, fixes, standard output
"$blvd" drive "$dir/rome.blvd" --via 41.893,12.503 --via 41.896,12.508 --start 41.8965,12.4995 --gnss -o - >"$dir/via" ||
	fail "no drive by stops"
grep -q ' 300#' "$dir/via" || fail "no fixes"

# wrong use and bad input
status() {
	set +e
	"$@" >"$dir/out" 2>&1
	got=$?
	set -e
}
status "$blvd" drive
[ $got = 2 ] || fail "usage: $got"
status "$blvd" drive "$dir/rome.blvd" --via 95,0 -o "$dir/x"
[ $got = 2 ] || fail "latitude: $got"
status "$blvd" drive "$dir/none.blvd" -o "$dir/x"
[ $got = 3 ] || fail "no package: $got"
status "$blvd" drive "$dir/truth" -o "$dir/x"
[ $got = 3 ] || fail "not a package: $got"
status "$blvd" drive "$dir/rome.blvd" --via 10,10 -o "$dir/x"
[ $got = 1 ] || fail "stop far away: $got"
status "$blvd" drive "$dir/rome.blvd" -o "$dir/no/such/folder/x"
[ $got = 1 ] || fail "no folder: $got"
status "$blvd" track "$dir/truth" --city "$dir/rome.blvd"
[ $got = 3 ] || fail "no log: $got"
[ ! -e "$dir/x" ] && [ ! -e "$dir/x.part" ] || fail "a file was left behind"

# a real car: dead reckoning against its own receiver
log=$data/can/css_canedge/drive_2024-09-07_aarhus-skanderborg_32min.candump.log.gz
if [ -f "$log" ]; then
	"$blvd" track "$log" --profile "$2/board/profiles/css_canedge.ini" --dbc "$data/can/dbc/canedge3-internal-gnss.dbc" \
		--dbc "$data/can/dbc/obd2_min.dbc" >"$dir/result"
	cat "$dir/result"
	sed -n 's/.*"stretches":\([0-9]*\), "p50":\([0-9.]*\).*/\1 \2/p' "$dir/result" |
		awk '{ exit !($1 > 90 && $2 < 35) }' || fail "the real drive drifts more than it did"
fi
