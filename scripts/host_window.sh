#!/usr/bin/env bash
# Runs the example `window` of crates/host without a window and under a virtual display, and looks at
# its pictures: `bash scripts/host_window.sh PROGRAM OUT`. Needs Xvfb, xdotool and ImageMagick.
set -euo pipefail
program=$1
out=$2
mkdir -p "$out"
for tool in Xvfb xdotool import convert compare; do
    command -v "$tool" >/dev/null || { echo "no $tool: apt-get install xvfb xdotool imagemagick libxkbcommon-x11-0 libxcursor1 libxi6"; exit 1; }
done

save() { "$program" --size 320x200 --preset "$1" --frames "$2" --save "$out/$3.png"; }
save none 1 unshaded
save light_buffer 1 first
save light_buffer 60 last
save rt 60 rays

# Number of pixels of the ground in shadow. They see the sky alone, so all have one color.
in_shadow() {
    local count
    count=$(convert "$1" -alpha off -fill black +opaque '#5d5d59' \
        -fill white -opaque '#5d5d59' -format '%[fx:round(mean*w*h)]' info:)
    echo "${count%%.*}"
}
expect() { # NAME, NUMBER, a comparison of test, ANOTHER
    echo "$1: $2 pixels"
    test "$2" "$3" "$4" || { echo "$1: expected $3 $4 pixels"; exit 1; }
}
# Of 64,000 pixels; 2,914 and 2,764 on llvmpipe.
expect 'the ground in shadow, no shadows' "$(in_shadow "$out/unshaded.png")" -eq 0
expect 'the ground in shadow, first frame' "$(in_shadow "$out/first.png")" -ge 1000
expect 'the ground in shadow, last frame' "$(in_shadow "$out/last.png")" -ge 1000
differ() { compare -metric AE "$out/$1.png" "$out/$2.png" null: 2>&1 || true; }
expect 'the first frame is not the last' "$(differ first last)" -ge 2000
expect 'light_buffer is not rt' "$(differ last rays)" -eq 0

display=:$((90 + RANDOM % 900))
Xvfb "$display" -screen 0 800x600x24 >"$out/xvfb.txt" 2>&1 &
server=$!
export DISPLAY=$display
unset WAYLAND_DISPLAY WAYLAND_SOCKET
opened=
trap 'kill $opened $server 2>/dev/null || true' EXIT
for _ in $(seq 100); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.1; done
"$program" --size 320x200 >"$out/program.txt" 2>&1 &
opened=$!
window=$(timeout 120 xdotool search --sync --onlyvisible --name '^Skiagraph in a program' | head -1)
xdotool windowmove "$window" 0 0
has_shadows() { # NAME: within two minutes
    local count
    for _ in $(seq 120); do
        kill -0 "$opened" || { echo "it has ended:"; cat "$out/program.txt"; exit 1; }
        import -window root "$out/$1.png"
        count=$(in_shadow "$out/$1.png")
        if [ "$count" -ge 500 ]; then echo "$1: $count pixels of the ground in shadow"; return; fi
        sleep 1
    done
    echo "$1: no shadows in two minutes"
    exit 1
}
has_shadows opened
xdotool windowsize --sync "$window" 90 50
xdotool windowsize --sync "$window" 640 400
has_shadows resized
# Where the smaller window did not reach, there is a picture and not the display's black.
is_filled() { [ "$(convert "$out/resized.png" -crop 300x180+330+210 -format '%[fx:minima>0.01]' info:)" = 1 ]; }
for _ in $(seq 60); do
    is_filled && break
    sleep 1
    import -window root "$out/resized.png"
done
is_filled || { echo "the picture did not follow the window's size"; exit 1; }
xdotool windowunmap --sync "$window"
xdotool windowmap --sync "$window"
has_shadows mapped_again
xdotool windowfocus --sync "$window" key Escape
for _ in $(seq 60); do kill -0 "$opened" 2>/dev/null || break; sleep 1; done
if kill -0 "$opened" 2>/dev/null; then echo "Escape does not close it"; exit 1; fi
wait "$opened" || { echo "closed: exit $?"; cat "$out/program.txt"; exit 1; }
opened=

# Without a display it says so and does not crash; what cannot be is an error.
fails() { # WORDS, arguments
    local status=0
    env -u DISPLAY "$program" "${@:2}" >"$out/fails.txt" 2>&1 || status=$?
    [ "$status" -eq 1 ] && grep -q "$1" "$out/fails.txt" || { echo "$*: exit $status"; cat "$out/fails.txt"; exit 1; }
}
fails 'DISPLAY is set'
fails 'did you mean' --preset light_bufer --save "$out/none.png"
echo "a host's window runs under a virtual display"
