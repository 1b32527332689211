#!/bin/sh
# the knob and the buttons change the picture; the knob alone reaches the menu and leaves it
needs_pins
unit_start
drive_start 20
pictures_come
drive_stop
seconds 3 # the car stands: what changes now is the driver's doing
screen still
turn right 3
seconds 1
screen closer
check 'turning the knob zooms' at_least 6400 "$(differ still closer)"
turn left 3
press rotary-push
seconds 1
screen menu
check 'a push opens the menu' at_least 6400 "$(differ closer menu)"
turn right 1
seconds 1
screen menu-next
check 'turning moves in the menu' at_least 400 "$(differ menu menu-next)"
press rotary-push 1500
seconds 1
screen menu-left
check 'a long push leaves the menu' at_least 6400 "$(differ menu-next menu-left)"
press view
seconds 1
screen view
check 'the view button changes the camera' at_least 25000 "$(differ menu-left view)"
close_pin night
seconds 2
screen night
check 'the lamps make it night' at_least 64000 "$(differ view night)"
open_pin night
