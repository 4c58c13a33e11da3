#!/usr/bin/env bash
# Compares shadow methods on a real scene: builds Skiagraph, installs a software Vulkan driver only
# where no adapter is found, then runs `skiagraph compare`. Without arguments it compares the methods
# that one would ship on the generated scene `park`, in well under a minute; `--all` compares all
# presets at 1024x1024. Further arguments are those of `compare`, presets first; paths in them count
# from this folder:
#
#   ./run.sh
#   ./run.sh --all
#   ./run.sh rt nsm --view all --size 512x512
#   ./run.sh --scene sponza --out out/my-sponza
#
# SKIAGRAPH_PROFILE=dev builds it as `./test.sh` does.
set -euo pipefail
cd "$(dirname "$0")"
# Without a session (a container, say) Mesa asks for this folder and complains on stderr.
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}"

size=512x512 frames=8 # as many as two times need to be told apart
if [ "${1:-}" = --all ] || { [ $# -gt 0 ] && [ "${1#-}" = "$1" ]; }; then
    size='' frames='' # all, or they are named
fi

scene='' out='' previous=''
for argument in "$@"; do
    case $previous in
        --scene) scene=$argument ;;
        --out) out=$argument ;;
    esac
    case $argument in
        --scene=*) scene=${argument#*=} ;;
        --out=*) out=${argument#*=} ;;
        --size | --size=*) size='' ;;
        --frames | --frames=*) frames='' ;;
    esac
    previous=$argument
done
if [ -z "$scene" ]; then
    scene=park
    set -- "$@" --scene "$scene"
fi
if [ -z "$out" ]; then
    out=out/$(basename "${scene%.*}")
    set -- "$@" --out "$out"
fi
[ -z "$size" ] || set -- "$@" --size "$size"
[ -z "$frames" ] || set -- "$@" --frames "$frames"

program=$(scripts/setup.sh "${SKIAGRAPH_PROFILE:-release}")
exec "$program" compare "$@"
