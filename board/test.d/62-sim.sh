#!/bin/sh
# short: the live car of blvd sim on vcan0, with faults on command
frames() { stat_of .vehicle.frames_in; }
heard() { [ "$(frames)" -gt "${1:-0}" ]; }
say() { echo "$*" >/run/sim; }
unit_start --display kms
blvd sim "$CITY" --can vcan0 --drive --seed 5 --wait 1 --control /run/sim --gpio "$PINS" </dev/null >/run/sim.log 2>&1 &
sim_pid=$!
check 'the car is heard' within 20 heard
sleep 4
screen sim-good
say lost:speed/4
sleep 2
screen sim-lost
check 'a lost signal is on the screen' at_least 300 "$(differ sim-good sim-lost)"
sleep 3
say busoff/4
sleep 1
before=$(frames)
sleep 1
check 'a bus that is off says nothing' at_most "$((before + 5))" "$(frames)"
screen sim-off
check 'which is on the screen' at_least 300 "$(differ sim-good sim-off)"
sleep 2.5
check 'and comes back' within 3 heard "$((before + 50))"
say clock:-31536000
say chatter:reverse/1
say range:speed/1
say noisy:yaw_rate/1
sleep 2.5
check 'nothing was restarted' test "$(unit_restarts)" = 0
say ignition off
sleep 4
screen sim-dark
check 'ignition off on the bus and on its pin: dark' at_most 2 "$(colours sim-dark)"
say ignition on
sleep 2
screen sim-lit
check 'and on again' at_least 50 "$(colours sim-lit)"
say quit
wait $sim_pid
check 'the simulation ended well' test $? = 0
note 'the simulation' "$(tail -1 /run/sim.log)"
