#!/bin/sh
# Asks the GPU of this machine what docs/adapters.md shows, in eight minutes at most, and says which
# folder to hand in. Needs a Vulkan, Metal or GL driver, and nothing else: no compiler, no network,
# no root.
#
#     ./adapter.sh                         the best GPU
#     ./adapter.sh --backend gl            through another interface
#     ./adapter.sh --adapter RADV          by part of its name or of its driver's
#     ./adapter.sh --small                 a short try
#
# Stopped, or out of time, it goes on with the same command. All words go to `skiagraph adapter`,
# whose --help says more.
set -eu
here=$(CDPATH='' cd -- "$(dirname -- "$0")" && pwd)
program=$here/skiagraph
test -x "$program" || { echo "there is no program $program: unpack the whole folder" >&2; exit 1; }
# What a machine cannot start at all is told here, and not in the rows.
"$program" --version >/dev/null || {
    echo "$program does not start here: it was built for $(cat "$here/built_for.txt")" >&2
    exit 1
}
SKIAGRAPH_ASSETS=$here/scenes
export SKIAGRAPH_ASSETS
# Scenes are found beside the program, and the folder of the rows is made there. A folder that is
# named is meant from where this script was called.
before=
for word in "$@"; do
    shift
    case $before,$word in
        --out,/* | *,--out=/*) ;;
        --out,*) word=$PWD/$word ;;
        *,--out=*) word=--out=$PWD/${word#--out=} ;;
    esac
    before=$word
    set -- "$@" "$word"
done
cd "$here"
exec "$program" adapter "$@"
