# A window shows what it is told to: by real keys and a real mouse, on a display of its own, read from its screenshots.
source "$(dirname "$0")/support.sh" "$@"
unset DISPLAY WAYLAND_DISPLAY SDL_VIDEODRIVER

# Without a display, or without windows at all
run view $scene
holds "without a display view fails" exits 1 '^kdray view: .*(no display for a window|without SDL2)'
holds "with one sentence" is "$(wc -l <err)" 1
run view $scene --screenshot gone/x.png
holds "a picture that cannot be written is refused first" exits 1 'gone/x.png cannot be written'
# What SDL2 and X11 have open at the end is theirs; the runs without a display look for leaks of the program's own.
no_leaks=${ASAN_OPTIONS:-}:detect_leaks=0
DISPLAY=:12345 ASAN_OPTIONS=$no_leaks run view $scene
holds "a display that is not there is none" exits 1 '^kdray view: .*(no display for a window|without SDL2)'
holds "and needs one sentence too" is "$(wc -l <err)" 1
touch mesh.ply
run view mesh.ply --screenshot mesh.ply
holds "the mesh file is not written over" exits 1 'would replace the mesh file'
refused() {
    run view "${@:2}"
    holds "view ${*:2} is refused" exits 2 "$1"
}
refused 'expected a mesh file'
refused 'expected one mesh file' a.ply b.ply
refused '--show: expected picture' $scene --show colour
refused '--frames: expected a whole number from 1' $scene --frames 0
refused '--fps: expected a number above 0' $scene --fps 0
refused '--resolution: expected WIDTHxHEIGHT' $scene -r 0x5
refused '--plan: ' $scene --plan split=x
refused '--screenshot: expected the name of a file' $scene --screenshot -
refused 'spp' $scene --spp 4
[[ ${KDR_WINDOW:-} == 1 ]] || finish

# No display, but a driver that was asked for
SDL_VIDEODRIVER=dummy run view builtin:explode:400 -r 64x48 --frames 5 --screenshot last.png --json last.json
holds "frames are counted" exits 0 '^5 frames: '
holds "the last picture is kept" is "$(png_size last.png)" 64x48
holds "with its figures" is "$(json last.json frames)" 5
holds "the tree was built for each that moved" is "$(json last.json builds)" 5
SDL_VIDEODRIVER=dummy run view builtin:explode:400 -r 64x48 --frames 3 --paused -q
holds "what is paused is built once, and quiet is quiet" exits 0
holds "nothing is said" empty err
SDL_VIDEODRIVER=dummy run view gone.ply
holds "a file that is not there is refused" exits 1 'gone.ply'
SDL_VIDEODRIVER=dummy run view $scene --camera 0,1,0 --target 0,0,0
holds "a camera that looks nowhere is refused" exits 1 'the camera looks nowhere'

# ---- a display
for tool in Xvfb xdotool; do
    holds "$tool is there" command -v $tool >/dev/null
done
Xvfb -displayfd 5 -screen 0 800x600x24 -nolisten tcp 5>display 2>/dev/null &
server=$!
trap 'kill $server 2>/dev/null; rm -rf "$work"' EXIT
for ((i = 0; i < 200; i++)); do
    [[ ! -s display ]] || break
    sleep 0.05
done
# Nothing can be said of windows where none opens: that ends the test, and fails it.
needs() {
    "${@:2}" && return
    holds "$1" false
    finish
}
needs "Xvfb opens a display" test -s display
export DISPLAY=:$(cat display) ASAN_OPTIONS=$no_leaks
window=
viewer=

# open ARGUMENT...: a window on something; $window and $viewer.
open() {
    env --default-signal "$kdray" view "$@" >out 2>err </dev/null &
    viewer=$!
    window=$(timeout 20 xdotool search --sync --onlyvisible --name '^kdray ' | head -1)
    needs "view opens a window" test -n "$window"
    xdotool windowfocus "$window" mousemove --window "$window" 60 60
}

# shot NAME: what is on view, into a file of that name.
taken=0
shot() {
    taken=$((taken + 1))
    local name
    name=$(printf 'kdray-%04d.png' $taken)
    xdotool key p
    for ((i = 0; i < 1000; i++)); do
        [[ ! -e $name ]] || break
        sleep 0.01
    done
    needs "P takes a screenshot" test -e "$name"
    cp "$name" "$1"
}

# press KEY... then shot NAME: press_shot NAME KEY...
press_shot() {
    xdotool key "${@:2}"
    shot "$1"
}

# leave [KEY]: ends the program; its status is in $status.
leave() {
    [[ $# -eq 0 ]] || xdotool key "$1"
    for ((i = 0; i < 200; i++)); do
        kill -0 $viewer 2>/dev/null || break
        sleep 0.05
    done
    kill -9 $viewer 2>/dev/null
    wait $viewer 2>/dev/null
    status=$?
}

# drag BUTTON DX DY: over the picture; several steps, as a hand does.
drag() {
    xdotool mousemove --window "$window" 60 60 mousedown "$1"
    for i in 1 2 3 4; do
        xdotool mousemove --window "$window" $((60 + $2 * i / 4)) $((60 + $3 * i / 4))
    done
    xdotool mouseup "$1"
}

open builtin:knot:2000 -r 160x120 -q
shot first.png
holds "a screenshot is a picture of the window's size" is "$(png_size first.png)" 160x120
shot again.png
holds "a picture that rests stays" cmp -s first.png again.png
holds "a screenshot never takes the name of another one" is "$(echo kdray-*)" "kdray-0001.png kdray-0002.png"

# What is shown
press_shot normals.png x
press_shot depth.png c
press_shot nodes.png v
press_shot triangles.png b
for a in first normals depth nodes triangles; do
    for b in first normals depth nodes triangles; do
        [[ ! $a < $b ]] || holds "$a and $b are shown differently" no cmp -s $a.png $b.png
    done
done
press_shot next.png Tab
holds "Tab goes through all" cmp -s next.png first.png
press_shot back.png shift+Tab
holds "and Shift goes back" cmp -s back.png triangles.png
press_shot cells.png z l
holds "cells are drawn" no cmp -s cells.png first.png
press_shot more.png period
holds "more cells" no cmp -s more.png cells.png
press_shot fewer.png comma
holds "fewer cells" cmp -s fewer.png cells.png
press_shot gone.png l
holds "no cells" cmp -s gone.png first.png
press_shot lit.png o
holds "shadows are taken away" no cmp -s lit.png first.png
press_shot gone.png o
holds "and given back" cmp -s gone.png first.png

# Plans and traversals change no hit, but what rays cost.
for key in 1 3 4 5 6 7 8 2; do
    press_shot plan.png $key
    holds "plan $key shows the same" cmp -s plan.png first.png
done
for i in 1 2 3 4 5; do
    press_shot trace.png t
    holds "traversal $i shows the same" cmp -s trace.png first.png
done
press_shot costs.png 5 v
holds "another plan has other costs" no cmp -s costs.png nodes.png
press_shot costs.png 2 t
holds "the same plan has the same" cmp -s costs.png nodes.png
xdotool key z

# Camera
drag 1 40 10
shot orbit.png
holds "a drag goes around" no cmp -s orbit.png first.png
press_shot home.png r
holds "R goes back" cmp -s home.png first.png
drag 2 20 10
shot pan.png
holds "the middle button shifts" no cmp -s pan.png first.png
xdotool key r keydown shift
drag 1 20 10
xdotool keyup shift
shot shifted.png
holds "so does Shift" cmp -s shifted.png pan.png
xdotool key r
drag 3 20 0
shot turn.png
holds "the right button turns the head" no cmp -s turn.png first.png
xdotool key r click 4 click 4
shot near.png
holds "the wheel goes nearer" no cmp -s near.png first.png
for key in w s a d q e; do
    xdotool key r $key
    shot fly-$key.png
    holds "$key flies" no cmp -s fly-$key.png first.png
done
holds "and not all one way" is "$(md5sum fly-*.png | cut -d' ' -f1 | sort -u | wc -l)" 6
xdotool key r keydown d
sleep 0.3
xdotool keyup d
shot held.png
holds "farther, the longer a key is held" no cmp -s held.png fly-d.png
press_shot home.png r
holds "R goes back from anywhere" cmp -s home.png first.png
xdotool click 5
press_shot home.png Home
holds "and Home, where nothing moves" cmp -s home.png first.png

# Text, and another size
press_shot plain.png i
holds "figures are not in a screenshot" cmp -s plain.png first.png
taken=$((taken + 1))
xdotool key i h F11
for ((i = 0; i < 400; i++)); do
    [[ ! -e $(printf 'kdray-%04d.png' $taken) ]] || break
    sleep 0.05
done
holds "but F11 has them" no cmp -s "$(printf 'kdray-%04d.png' $taken)" first.png
xdotool key h windowsize --sync "$window" 200 90
shot wide.png
holds "another size is another picture" is "$(png_size wide.png)" 200x90
leave Escape
holds "Esc quits" exits 0
holds "without a word" empty err

# What moves
open builtin:explode:500 -r 120x90 --fps 2 --paused -q
shot begin.png
sleep 0.3
shot still.png
holds "what is paused stands still" cmp -s begin.png still.png
press_shot on.png Right
holds "an arrow goes on by a frame" no cmp -s on.png begin.png
press_shot on2.png Right
holds "and on" no cmp -s on2.png on.png
press_shot back.png Left
holds "and back" cmp -s back.png on.png
press_shot second.png bracketright
press_shot back.png Right Right Home Right Right Right
holds "frames and seconds are one time" cmp -s back.png second.png
press_shot back.png Home
holds "Home is the beginning" cmp -s back.png begin.png
xdotool key space
sleep 0.3
shot playing.png
sleep 0.2
shot playing2.png
holds "space plays" no cmp -s playing.png playing2.png
xdotool key space
shot paused.png
sleep 0.3
shot paused2.png
holds "space pauses" cmp -s paused.png paused2.png
# The bar begins on the left, near the lower border.
xdotool mousemove --window "$window" 14 75 mousedown 1 mousemove --window "$window" 5 75 mouseup 1
shot bar.png
holds "the bar goes to a moment" cmp -s bar.png begin.png
leave Escape
holds "Esc quits what moves too" exits 0

# A sequence of files; one that is wrong ends it.
for i in 1 2 3; do printf 'v 0 0 0\nv %s 0 0\nv 0 1 0\nf 1 2 3\n' $i >walk$i.obj; done
open 'walk#.obj' -r 80x60 --paused -q --fps 5 --camera 1,1,6 --target 1,0.5,0
shot one.png
press_shot two.png Right
holds "a sequence goes file by file" no cmp -s one.png two.png
run render walk3.obj -r 80x60 --camera 1,1,6 --target 1,0.5,0 -o three.png -q
echo 'not a mesh' >walk3.obj
xdotool key Right
leave
holds "a file that is wrong ends it with its name" exits 1 'walk3.obj: '

open $scene -r 80x60
kill -s INT $viewer
leave
holds "SIGINT ends it" exits 1 '^kdray view: cancelled$'
kill $server
finish
