#!/bin/sh
# Every shader, with what the loader puts in front of it, is valid GLSL ES 3.00.
dir=$2/assets/shaders
command -v glslangValidator >/dev/null || { echo "skipped: no glslangValidator"; exit 77; }
tmp=$(mktemp -d) && trap 'rm -rf "$tmp"' EXIT
bad=0
for file in "$dir"/*.vert "$dir"/*.frag; do
	stage=${file##*.}
	[ "$stage" = vert ] && word=VERTEX || word=FRAGMENT
	{
		printf '#version 300 es\n#define %s 1\n' $word
		cat "$dir/prelude.glsl"
		printf '#line 1\n'
		cat "$file"
	} >"$tmp/shader.$stage"
	if ! glslangValidator "$tmp/shader.$stage" >"$tmp/log"; then
		echo "$file:"
		cat "$tmp/log"
		bad=1
	fi
done
exit $bad
