#!/usr/bin/env bash
# Starts `skiagraph view` under a virtual display, drives it with keys and the pointer, and looks at
# what is on the screen: `bash scripts/window.sh PROGRAM OUT`. Needs Xvfb, xdotool and ImageMagick.
set -euo pipefail
program=$1
out=$2
mkdir -p "$out"
for tool in Xvfb xdotool import convert compare; do
    command -v "$tool" >/dev/null || { echo "no $tool: apt-get install xvfb xdotool imagemagick libxkbcommon-x11-0 libxcursor1 libxi6"; exit 1; }
done

display=:$((90 + RANDOM % 900))
Xvfb "$display" -screen 0 1280x800x24 >"$out/xvfb.txt" 2>&1 &
server=$!
export DISPLAY=$display
unset WAYLAND_DISPLAY WAYLAND_SOCKET
view=
trap 'kill $view $server 2>/dev/null || true' EXIT
for _ in $(seq 100); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.1; done

"$program" view nsm --scene park --size 160x120 --map-size 256 >"$out/view.txt" 2>&1 &
view=$!
window=$(timeout 120 xdotool search --sync --onlyvisible --name '^Skiagraph$' | head -1)
xdotool windowmove "$window" 0 0
shot() { import -window root "$out/$1.png"; }
# Whether there is a picture where the panel's dark ground was.
is_there() { [ "$(convert "$out/start.png" -crop 400x300+400+100 -format '%[fx:mean>0.35]' info:)" = 1 ]; }

for _ in $(seq 120); do
    shot start
    is_there && break
    kill -0 "$view" || { echo "it has ended:"; cat "$out/view.txt"; exit 1; }
    sleep 1
done
is_there || { echo "nothing was drawn in two minutes"; exit 1; }

differs() { # from the first picture, in more than a line of text
    local pixels
    pixels=$(compare -metric AE "$out/start.png" "$out/$1.png" null: 2>&1 || true)
    echo "$1: $pixels pixels differ"
    [ "${pixels%%.*}" -gt 20000 ]
}
drive() {
    local name=$1
    shift
    "$@"
    for _ in $(seq 60); do shot "$name"; differs "$name" && return; sleep 1; done
    echo "$name: the picture stays as it was"
    exit 1
}
# Slowly: a press and its release within one frame are a click.
look() {
    xdotool mousemove 800 250 sleep 0.7 mousedown 1 sleep 0.7 mousemove 840 260 sleep 0.7 \
        mousemove 900 270 sleep 0.7 mouseup 1
}
drive looked look
kill "$view" && wait "$view" 2>/dev/null || true
view=

# Without a display it says so and does not crash.
status=0
env -u DISPLAY "$program" view >"$out/without.txt" 2>&1 || status=$?
[ "$status" -eq 3 ] || { echo "without a display: exit $status"; cat "$out/without.txt"; exit 1; }
grep -q 'needs a display' "$out/without.txt" || { cat "$out/without.txt"; exit 1; }
if grep -q panicked "$out/without.txt"; then cat "$out/without.txt"; exit 1; fi
echo "the window runs under a virtual display"
