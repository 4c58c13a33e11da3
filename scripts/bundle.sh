#!/usr/bin/env bash
# Makes the folder that asks any GPU (docs/adapters.md): the program without its window, Sponza, and
# adapter.sh. It needs no compiler and no network where it runs.
#
#     scripts/bundle.sh                      target/bundle/skiagraph-adapter, and a .tar.gz beside it
#     scripts/bundle.sh --out DIR
#     scripts/bundle.sh --program PATH       of a program that was built already
#     scripts/bundle.sh --small …            without Sponza, for the small rows; of any size
#
# Sponza comes from $SKIAGRAPH_ASSETS. Exit 1 if the folder is larger than 48 MiB.
set -euo pipefail
cd "$(dirname "$0")/.."
most=$((48 * 1024 * 1024))
out=target/bundle/skiagraph-adapter
program=
small=
while [ $# -gt 0 ]; do
    case $1 in
        --out) out=$2; shift 2 ;;
        --program) program=$2; shift 2 ;;
        --small) small=yes; shift ;;
        *) echo "unknown word $1; there are --out DIR, --program PATH and --small" >&2; exit 2 ;;
    esac
done
mesh=${SKIAGRAPH_ASSETS:-}/sponza/sponza.obj
test -n "$small" || test -s "$mesh" ||
    { echo "there is no $mesh: name the folder of meshes in SKIAGRAPH_ASSETS, or take --small" >&2; exit 1; }
if [ -z "$program" ]; then
    cargo build --release --locked -p skiagraph --no-default-features --bin skiagraph
    program=${CARGO_TARGET_DIR:-target}/release/skiagraph
fi
rm -rf "$out" "$out.tar.gz"
mkdir -p "$out/scenes"
strip -o "$out/skiagraph" "$program"
cp scenes/lamps.ron "$out/scenes/" # the others are in the program
if [ -z "$small" ]; then
    mkdir "$out/scenes/sponza"
    cp "$(dirname "$mesh")/LICENSE.txt" "$out/scenes/sponza/"
    # No row reads texture coordinates: a quarter of the file. The triangles stay what they are.
    awk '/^vt / { next } /^f / { gsub(/\/[0-9]+\//, "//") } { print }' "$mesh" >"$out/scenes/sponza/sponza.obj"
fi
cp scripts/adapter.sh LICENSE-MIT LICENSE-APACHE docs/adapters.md "$out/"
# The newest symbol of the C library tells how old a system may be.
libc=$(objdump -T "$out/skiagraph" | grep -o 'GLIBC_[0-9.]*' | sort -uV | tail -n 1 | tr _ ' ')
echo "$(uname -m) $(uname -s), ${libc:-any C library} or newer" >"$out/built_for.txt"
bytes=$(find "$out" -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum }')
printf '%s: %d MiB, for %s\n' "$out" "$((bytes / 1024 / 1024))" "$(cat "$out/built_for.txt")"
test -n "$small" || test "$bytes" -le "$most" || { echo "$out is larger than 48 MiB" >&2; exit 1; }
tar -czf "$out.tar.gz" -C "$(dirname "$out")" "$(basename "$out")"
