#!/bin/sh
# Bad input: exit status 3 (2 for a wrong command line), one clear line that names the file, nothing half-written left behind.
set -u
build=$1
blvd=$build/tools/blvd
boulevard=$build/board/boulevard
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1
faults=0
checks=0

# expect STATUS WORD COMMAND...: the command ends with STATUS, and the last line on stderr holds WORD.
expect() {
	status=$1 word=$2
	shift 2
	"$@" >out.txt 2>err.txt </dev/null
	got=$?
	checks=$((checks + 1))
	if [ $got -ne "$status" ]; then
		echo "FAILED: status $got instead of $status: $*"
		cat err.txt
		faults=$((faults + 1))
	elif [ -n "$word" ] && ! grep -q -- "$word" err.txt; then
		echo "FAILED: no '$word' in the message of: $*"
		cat err.txt
		faults=$((faults + 1))
	elif [ "$status" -eq 3 ] && [ "$(grep -c ': error: ' err.txt)" -ne 1 ]; then
		echo "FAILED: not exactly one error line from: $*"
		cat err.txt
		faults=$((faults + 1))
	fi
	for left in result.blvd result.blvd.part result.osm result.osm.part result.candump result.candump.part; do
		[ ! -e $left ] || { echo "FAILED: $left was left behind by: $*"; faults=$((faults + 1)); rm -f $left; }
	done
}

# flip FILE OFFSET: changes one byte.
flip() {
	byte=$(dd if="$1" bs=1 skip="$2" count=1 2>/dev/null | od -An -tu1 | tr -d ' ')
	printf "$(printf '\\%03o' $(((byte + 85) % 256)))" | dd of="$1" bs=1 seek="$2" conv=notrunc 2>/dev/null
}

# command lines
expect 2 usage "$blvd"
expect 2 nonsense "$blvd" nonsense
expect 2 'no input' "$blvd" bake -o result.blvd
expect 2 'no output' "$blvd" bake x.osm
expect 2 'bbox' "$blvd" bake --bbox 1,2,3 x.osm -o result.blvd
expect 2 'no city' "$boulevard"
expect 2 'size' "$boulevard" x.blvd --size 3x3
expect 2 'tau' "$boulevard" x.blvd --tau 1000
expect 2 'budget' "$boulevard" x.blvd --budget 1
expect 2 'every' "$boulevard" x.blvd --every 0

# map files
: >empty.osm
mkdir folder.osm
printf '<osm version="0.6"><node id="1" lat="0" lon="0"/>' >cut.osm
printf '<osm version="0.6">\n<node id="1" lat="x" lon="0"/>\n</osm>\n' >number.osm
printf '<html></html>' >other.osm
printf 'not a map at all' >text.osm.pbf
printf '\037\213\010\000garbage' >cut.osm.gz
printf 'BZh9garbage' >cut.osm.bz2
printf '{"type": "CityJSON", "version": ' >cut.city.json
for file in missing.osm missing.osm.pbf empty.osm folder.osm cut.osm other.osm text.osm.pbf cut.osm.gz cut.osm.bz2 cut.city.json; do
	expect 3 "$file" "$blvd" bake $file -o result.blvd
done
expect 3 'nofont' "$blvd" bake --font nofont.ttf -o result.blvd "$2/tests/tools/data/crossing.osm"
expect 3 'noterrain' "$blvd" bake --terrain noterrain.hgt -o result.blvd "$2/tests/tools/data/crossing.osm"
expect 3 'nobuildings' "$blvd" bake --buildings nobuildings.shp -o result.blvd "$2/tests/tools/data/crossing.osm"

# a sound package, log and DBC, then what is wrong with them
"$blvd" bake -q "$2/tests/tools/data/crossing.osm" -o good.blvd || { echo 'FAILED: bake'; exit 1; }
"$blvd" drive good.blvd --seed 1 --minutes 0.3 -o good.candump || { echo 'FAILED: drive'; exit 1; }
for cut in 0 1 63 64 100 4095 4096 9000; do
	head -c $cut good.blvd >cut.blvd
	expect 3 cut.blvd "$blvd" verify cut.blvd
	expect 3 cut.blvd "$boulevard" cut.blvd --replay good.candump --headless --limit 1
done
size=$(stat -c %s good.blvd)
for offset in 0 9 17 25 33 70 90 4100 4200 $((size / 3)) $((size / 2)) $((size - 100)); do
	cp good.blvd flipped.blvd
	flip flipped.blvd "$offset"
	expect 3 flipped.blvd "$blvd" verify flipped.blvd
	"$boulevard" flipped.blvd --replay good.candump --headless --size 64x64 --limit 2 >out.txt 2>err.txt </dev/null
	got=$?
	checks=$((checks + 1))
	[ $got -eq 3 ] || [ $got -eq 0 ] || { echo "FAILED: status $got for a package with byte $offset flipped"; cat err.txt; faults=$((faults + 1)); }
done
expect 3 good.candump "$blvd" verify good.candump
expect 3 missing.blvd "$boulevard" missing.blvd --replay good.candump --headless
expect 3 missing.candump "$boulevard" good.blvd --replay missing.candump --headless
expect 3 empty.osm "$boulevard" good.blvd --replay empty.osm --headless
printf 'BO_ 1 A: 8 X\n SG_ Broken : 0|99@1+ (1,0) [0|1] "" X\n' >broken.dbc
expect 3 broken.dbc "$boulevard" good.blvd --replay good.candump --headless --dbc broken.dbc --limit 1
expect 3 missing.dbc "$boulevard" good.blvd --replay good.candump --headless --dbc missing.dbc --limit 1
printf '[display]\nwidth = lots\n' >broken.ini
expect 3 broken.ini "$boulevard" good.blvd --replay good.candump --headless --profile broken.ini --limit 1
expect 3 missing.ini "$boulevard" good.blvd --replay good.candump --headless --profile missing.ini --limit 1

# live too: a file that is asked for is there, or nothing is begun
expect 3 missing.gnss "$boulevard" good.blvd --replay good.candump --headless --gnss missing.gnss --limit 1
expect 3 missing.gnss "$boulevard" good.blvd --can unix:bus --headless --size 64x64 --gnss missing.gnss --limit 1
expect 3 missing.dbc "$boulevard" good.blvd --can unix:bus --headless --size 64x64 --dbc missing.dbc --limit 1

# nonsense in a log is counted, not fatal
{ cat good.candump; echo 'nonsense'; echo '(1.0) can0 ZZZ#00'; echo '(2'; } >noisy.candump
expect 0 '' "$boulevard" good.blvd --replay noisy.candump --headless --size 64x64 --fps 5 --stats stats.json
bad=$(jq .vehicle.frames_bad stats.json)
[ "$bad" -ge 3 ] || { echo "FAILED: $bad bad frames counted instead of 3"; faults=$((faults + 1)); }

# more must be resident at once than the budget has: refused with both numbers
"$blvd" bake -q --far pvs --cells 0-0 good.blvd -o cells.blvd || { echo 'FAILED: bake'; exit 1; }
bound=$("$blvd" inspect --json cells.blvd | jq -r '.resident_bound_bytes * 10 / 1048576 | round | "\(. / 10 | floor).\(. % 10)"')
expect 3 "needs $bound MiB resident for its cells, a budget of 6.0 MiB leaves" "$boulevard" cells.blvd --replay good.candump --headless --size 64x64 \
	--samples 1 --far impostor --budget 6 --limit 1
expect 0 '' "$boulevard" cells.blvd --replay good.candump --headless --size 64x64 --samples 1 --far impostor --budget 64 --limit 1

# a folder that cannot be written
expect 1 '/nonexistent' "$blvd" bake -q "$2/tests/tools/data/crossing.osm" -o /nonexistent/x.blvd
expect 1 '/nonexistent' "$boulevard" good.blvd --replay good.candump --headless --size 64x64 --limit 1 --frames /nonexistent/frames

expect 1 '/nonexistent' "$boulevard" good.blvd --can unix:bus --headless --size 64x64 --limit 1 --record /nonexistent/log

# a profile that names no signals: a car that says nothing is a state
printf '[display]\nnonsense = 1\n' >silent.ini
expect 0 'silent.ini:2' "$boulevard" good.blvd --replay good.candump --headless --profile silent.ini --size 64x64 --limit 3

# a city of nothing is refused; streets alone and houses alone are cities
printf '<osm version="0.6">\n</osm>\n' >nothing.osm
expect 3 nothing.osm "$blvd" bake -q nothing.osm -o nothing.blvd
sed '/building/d' "$2/tests/tools/data/crossing.osm" >streets.osm
sed '/highway/d' "$2/tests/tools/data/crossing.osm" >houses.osm
for city in streets houses; do
	expect 0 '' "$blvd" bake -q $city.osm -o $city.blvd
	expect 0 '' "$blvd" verify $city.blvd
	expect 0 '' "$boulevard" $city.blvd --replay good.candump --headless --size 64x64 --limit 3
done

echo "$checks checks, $faults failed"
[ $faults -eq 0 ]
