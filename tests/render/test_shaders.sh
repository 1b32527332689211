#!/bin/sh
# Every shader, with what the loader puts in front of it, is valid GLSL ES 3.00; resolve.* ES 3.10.
dir=$2/assets/shaders
command -v glslangValidator >/dev/null || { echo "skipped: no glslangValidator"; exit 77; }
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
bad=0
check() # FILE DEFINES
{
	file=$1
	stage=${file##*.} version=300
	case $file in */resolve.*) version=310 ;; esac
	[ "$stage" = vert ] && word=VERTEX || word=FRAGMENT
	{
		printf '#version %s es\n#define %s 1\n' $version $word
		printf "$2"
		cat "$dir/prelude.glsl"
		printf '#line 1\n'
		cat "$file"
	} >"$tmp/shader.$stage"
	if ! glslangValidator "$tmp/shader.$stage" >"$tmp/log"; then
		echo "$file:"
		cat "$tmp/log"
		bad=1
	fi
}
for file in "$dir"/*.vert "$dir"/*.frag; do
	case $file in
	*/resolve.*) check "$file" "#define NO_FRAME_BLOCK 1\n#define SAMPLES 4\n" ;;
	*) check "$file" "" ;;
	esac
done
for look in HAS_WALL HAS_GROUND HAS_WATER; do
	for file in "$dir"/city.*; do
		check "$file" "#define $look 1\n"
		check "$file" "#define $look 1\n#define FADE 1\n"
		check "$file" "#define $look 1\n#define LIT 1\n"
	done
done
for file in "$dir"/city.*; do
	check "$file" "#define HAS_WALL 1\n#define HAS_GROUND 1\n#define HAS_WATER 1\n#define LIT 1\n#define FADE 1\n"
done
for file in "$dir"/truth.* "$dir"/capture.*; do
	check "$file" "#define NO_FRAME_BLOCK 1\n"
	check "$file" "#define NO_FRAME_BLOCK 1\n#define COLOR 1\n"
done
for file in "$dir"/text.*; do
	check "$file" "#define SHAPE 1\n"
done
for file in "$dir"/sky.*; do
	check "$file" "#define GRID 1\n"
	check "$file" "#define SUN 1\n"
done
for style in LIT DISSOLVE TINT WIRE; do
	for file in "$dir"/impostor.*; do
		check "$file" "#define $style 1\n"
	done
done
exit $bad
