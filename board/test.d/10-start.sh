#!/bin/sh
# short: the unit starts, says that it is ready, lives, is watched, and stops
started=$(now_ms)
check 'the unit starts and says that it is ready' unit_start
note 'start to ready, native ms' "$(native $(($(now_ms) - started)) start)"
check 'it runs as its own user' test "$(ps -o user= -p "$(unit_pid)")" = boulevard
groups_of() { sed -n 's/^Groups:[[:space:]]*//p' "/proc/$(unit_pid)/status" | tr ' ' '\n' | grep . | while read -r id; do getent group "$id" | cut -d: -f1; done | sort | tr '\n' ' '; }
check 'it is in the groups it needs and no other' test "$(groups_of)" = 'boulevard gpio input render video '
check 'it has no capability' grep -q '^CapEff:[[:space:]]*0000000000000000$' "/proc/$(unit_pid)/status"
check 'it cannot gain any' grep -q '^NoNewPrivs:[[:space:]]*1$' "/proc/$(unit_pid)/status"
# Seen from inside: every mount that can be written and is no device, proc or its own /tmp.
writable() { awk '$6 ~ /(^|,)rw(,|$)/ && $5 !~ "^/(dev|proc|sys|tmp|var/tmp|run)(/|$)" { print $5 }' "/proc/$(unit_pid)/mountinfo" | sort -u; }
check 'it can write its state folder and nothing else' test "$(writable)" = /var/lib/boulevard
seconds 3
check 'the watchdog is fed' unit_running
check 'it was never restarted' test "$(unit_restarts)" = 0
kill -STOP "$(unit_pid)"
before=$(unit_pid)
check 'a picture that stands is started again' within 6 start sh -c "[ \"\$(systemctl show -P MainPID boulevard)\" != $before ] && systemctl is-active boulevard"
note 'frozen to ready again, native ms' "$took_ms"
check 'the unit stops when asked' unit_stop
check 'it stopped with success' test "$(systemctl show -P Result boulevard)" = success
note 'exposure by systemd-analyze security' "$(systemd-analyze security boulevard --no-pager 2>/dev/null | sed -n 's/.*exposure level for boulevard.service: \([0-9.]* [A-Z]*\).*/\1/p')"
