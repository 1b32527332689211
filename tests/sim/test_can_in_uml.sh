#!/bin/sh
# The kernel's CAN without a car and without root: test_can_socketcan inside User-Mode Linux, which brings vcan as a
# module. Skipped where user-mode-linux is not installed. BLVD_UML is the folder of an unpacked package instead of /.
build=$(cd "$1" && pwd)
uml=${BLVD_UML:-}
grep -q '^BLVD_SANITIZE:BOOL=ON' "$build/CMakeCache.txt" && { echo "skipped: no sanitizers in so small a machine"; exit 77; }
linux=$uml/usr/bin/linux.uml
command -v insmod ip > /dev/null || { echo "skipped: no insmod or ip (packages kmod, iproute2)"; exit 77; }
[ -x "$linux" ] || { echo "skipped: no $linux (package user-mode-linux)"; exit 77; }
modules=$(ls -d "$uml"/usr/lib/uml/modules/*/kernel | head -1)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cat > "$work/init" <<END
#!/bin/sh
export PATH=/usr/sbin:/usr/bin:/sbin:/bin
mount -t proc proc /proc
mount -t sysfs sysfs /sys
for module in net/can/can net/can/can-raw drivers/net/can/dev/can-dev drivers/net/can/vcan; do
	insmod $modules/\$module.ko
done
ip link add vcan0 type vcan && ip link set vcan0 mtu 72 up
[ -e /sys/class/net/vcan0 ] && BLVD_VCAN_CONTROL=1 $build/tests/platform_test_can_socketcan && echo UML-TEST-PASSED
echo o > /proc/sysrq-trigger
sleep 10
END
chmod +x "$work/init"
timeout 60 "$linux" mem=256M rootfstype=hostfs rootflags=/ ro init="$work/init" con=null con0=fd:0,fd:1 quiet \
	> "$work/log" 2>&1 < /dev/null
cat "$work/log"
grep -q UML-TEST-PASSED "$work/log"
