#!/usr/bin/env bash
# Compares the shadow methods on a real scene: builds Skiagraph, installs a software Vulkan driver
# only where no adapter is found, then runs `skiagraph compare` on the generated scene `park`.
# Arguments are added to `compare`; paths in them count from this folder:
#
#   ./run.sh
#   ./run.sh rt nsm --view all --size 512x512
#   ./run.sh --scene sponza --out out/my-sponza
set -euo pipefail
cd "$(dirname "$0")"
# Without a session (a container, say) Mesa asks for this folder and complains on stderr.
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}"

scene='' out='' previous=''
for argument in "$@"; do
    case $previous in
        --scene) scene=$argument ;;
        --out) out=$argument ;;
    esac
    case $argument in
        --scene=*) scene=${argument#*=} ;;
        --out=*) out=${argument#*=} ;;
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

scripts/setup.sh --release
cargo run --quiet --release --locked --bin skiagraph -- compare "$@"
