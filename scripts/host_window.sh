#!/usr/bin/env bash
# Runs the example `window` of crates/host under a virtual display, and looks at its pictures:
# `bash scripts/host_window.sh PROGRAM OUT`. Needs Xvfb, xdotool and ImageMagick.
set -euo pipefail
program=$1
out=$2
mkdir -p "$out"
for tool in Xvfb xdotool import convert compare; do
    command -v "$tool" >/dev/null || { echo "no $tool: apt-get install xvfb xdotool imagemagick libxkbcommon-x11-0 libxcursor1 libxi6"; exit 1; }
done

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

display=:$((90 + RANDOM % 900))
Xvfb "$display" -screen 0 960x600x24 >"$out/xvfb.txt" 2>&1 &
server=$!
export DISPLAY=$display
unset WAYLAND_DISPLAY WAYLAND_SOCKET
opened=
trap 'kill $opened $server 2>/dev/null || true' EXIT
for _ in $(seq 100); do xdotool getdisplaygeometry >/dev/null 2>&1 && break; sleep 0.1; done
opens() { # arguments of the program
    "$program" "$@" >"$out/program.txt" 2>&1 &
    opened=$!
    window=$(timeout 120 xdotool search --sync --onlyvisible --name '^Skiagraph in a program' | head -1)
    xdotool windowmove "$window" 0 0
    xdotool windowsize --sync "$window" 320 200
}
closes() {
    xdotool windowfocus --sync "$window" key Escape
    for _ in $(seq 60); do kill -0 "$opened" 2>/dev/null || break; sleep 1; done
    if kill -0 "$opened" 2>/dev/null; then echo "Escape does not close it"; exit 1; fi
    wait "$opened" || { echo "closed: exit $?"; cat "$out/program.txt"; exit 1; }
    opened=
}
shot() { # NAME, WIDTHxHEIGHT: taken once the whole of it is a picture and not the display's black
    for _ in $(seq 120); do
        kill -0 "$opened" || { echo "it has ended:"; cat "$out/program.txt"; exit 1; }
        import -window root -crop "$2+0+0" +repage "$out/$1.png"
        if [ "$(convert "$out/$1.png" -format '%[fx:minima>0.01]' info:)" = 1 ]; then return; fi
        sleep 1
    done
    echo "$1: no picture in two minutes"
    exit 1
}
still() { # NAME, PRESET, SECONDS: twice the same picture, so that none is of an older size
    opens "$2" "$3"
    for _ in $(seq 60); do
        shot "$1" 320x200
        sleep 2
        shot again 320x200
        if [ "$(differ "$1" again)" -eq 0 ]; then closes; return; fi
    done
    echo "$1: it does not stand still"
    exit 1
}
differ() { compare -metric AE "$out/$1.png" "$out/$2.png" null: 2>&1 || true; }

still unshaded none 0
still first light_buffer 0
still last light_buffer 2
still rays rt 2
# Of 64,000 pixels; 2,914 and 2,764 on llvmpipe.
expect 'the ground in shadow, no shadows' "$(in_shadow "$out/unshaded.png")" -eq 0
expect 'the ground in shadow, first frame' "$(in_shadow "$out/first.png")" -ge 1000
expect 'the ground in shadow, last frame' "$(in_shadow "$out/last.png")" -ge 1000
expect 'the first frame is not the last' "$(differ first last)" -ge 2000
expect 'light_buffer is not rt' "$(differ last rays)" -eq 0

opens
has_shadows() { # NAME, WIDTHxHEIGHT: the first pictures may be a corner of those of the size before
    for _ in $(seq 30); do
        shot "$1" "$2"
        [ "$(in_shadow "$out/$1.png")" -lt 500 ] || break
        sleep 1
    done
    expect "$1, the ground in shadow" "$(in_shadow "$out/$1.png")" -ge 500
}
has_shadows opened 320x200
shot later 320x200
expect 'nothing moves' "$(differ opened later)" -ge 1
xdotool windowsize --sync "$window" 90 50
xdotool windowsize --sync "$window" 640 400
has_shadows resized 640x400
xdotool windowunmap --sync "$window"
xdotool windowmap --sync "$window"
has_shadows mapped_again 640x400
closes

# Without a display it says so and does not crash; what cannot be is an error.
fails() { # WORDS, command
    local status=0
    "${@:2}" >"$out/fails.txt" 2>&1 || status=$?
    [ "$status" -eq 1 ] && grep -q "$1" "$out/fails.txt" || { echo "$*: exit $status"; cat "$out/fails.txt"; exit 1; }
}
fails 'DISPLAY is set' env -u DISPLAY "$program"
fails 'did you mean' "$program" light_bufer
fails 'invalid float' "$program" rt noon
echo "a host's window runs under a virtual display"
