#!/bin/sh
# A disk that fills while `blvd bake` works (here: files that may not grow past a size, which needs no root): the old package stays whole,
# one line says why, no part of a package is left, and the bake that goes on later makes the same bytes as one that was never stopped.
# Arguments: build folder, source folder.
set -u
blvd=$1/tools/blvd
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
cd "$dir" || exit 1
faults=0
fail() {
	echo "FAILED: $*"
	faults=$((faults + 1))
}

"$blvd" bake -q "$2/tests/tools/data/crossing.osm" -o city.blvd || exit 1
"$blvd" bake -q city.blvd --far all --cells 0-3 -o far.blvd || exit 1
cp far.blvd before.blvd
"$blvd" bake -q city.blvd --far all --tau 2 --cells 0-3 -o straight.blvd || exit 1
size=$(($(stat -c %s straight.blvd) / 512))

# one block: not even a unit; then somewhere in the package, to its last block
for blocks in 1 100 $((size / 2)) $((size - 1)); do
	(
		ulimit -f $blocks
		exec "$blvd" bake -q city.blvd --far all --tau 2 --cells 0-3 --units units -o far.blvd
	) 2>err.txt
	status=$?
	[ $status -eq 1 ] || fail "status $status with $blocks blocks"
	[ "$(grep -c ': error: ' err.txt)" -ge 1 ] || fail "nothing was said with $blocks blocks"
	cmp -s far.blvd before.blvd || fail "the package was touched with $blocks blocks"
	[ ! -e far.blvd.part ] || fail "a part of the package was left with $blocks blocks"
done
"$blvd" verify far.blvd >/dev/null || fail 'the old package is not sound'

# the same for one whose units lie beside the package
(
	ulimit -f 100
	exec "$blvd" bake -q city.blvd --far all --tau 2 --cells 0-3 -o far.blvd
) 2>err.txt && fail 'status 0'
cmp -s far.blvd before.blvd || fail 'the package was touched'

# room again: it goes on where it stopped
for units in --units=units ''; do
	cp before.blvd far.blvd
	"$blvd" bake -q city.blvd --far all --tau 2 --cells 0-3 $units -o far.blvd || fail 'the bake does not go on'
	cmp -s far.blvd straight.blvd || fail 'other bytes than of a bake that was never stopped'
done
find . -name '*.part' | grep -q . && fail "left: $(find . -name '*.part')"
[ ! -e far.blvd.cells ] || fail 'the units were left'
[ $faults -eq 0 ]
