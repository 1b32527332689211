#!/bin/sh
# Data moves one way: a room may include only rooms upstream of it. Also: GL in one file, no heap in the runtime.
set -u
cd "$2" || exit 1
faults=0

complain() {
	echo "$1"
	faults=$((faults + 1))
}

# allow ROOM_FOLDER PATTERN: every #include "..." in the folder must match the pattern.
allow() {
	for file in $(find "$1" -name '*.[ch]'); do
		for header in $(sed -n 's/^#include "\([^"]*\)".*/\1/p' "$file"); do
			echo "$header" | grep -Eq "^($2)/" || complain "$file includes $header"
		done
	done
}
allow platform/base 'platform/base'
allow platform 'platform'
allow assets 'assets|platform/base'
allow nav 'nav|assets|platform'
allow render 'render|nav|assets|platform'
allow board 'board|render|nav|assets|platform'
allow tools 'tools|board|render|nav|assets|platform'

for file in $(grep -rlE '#include <(GLES[23]|GL)/' --include='*.[ch]' platform assets nav render board tools); do
	[ "$file" = render/gfx_gles3.c ] || [ "$file" = render/gpu_timer.c ] || complain "$file includes GL"
done
for file in $(grep -rlE '\b(malloc|calloc|realloc|strdup|free)\(' --include='*.[ch]' platform assets nav render board); do
	complain "$file uses the heap: $(grep -nE '\b(malloc|calloc|realloc|strdup|free)\(' "$file" | head -1)"
done
for file in $(grep -rlE '\b(open|fopen|socket|ioctl|clock_gettime)\(' --include='*.[ch]' nav render); do
	complain "$file talks to the system"
done

[ "$faults" -eq 0 ] && echo "every include points upstream"
[ "$faults" -eq 0 ]
