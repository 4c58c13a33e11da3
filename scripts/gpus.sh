#!/usr/bin/env bash
# Measures on a GPU what docs/gpus.md and docs/results/h200.md show, in about ten minutes on a fast
# one; each row into a folder of its own, and on after one that fails:
#
#     scripts/gpus.sh out/my-gpu                 all rows
#     scripts/gpus.sh out/my-gpu moving city     rows whose names begin so
#
# PROGRAM: another program than target/release/skiagraph.
set -uo pipefail
out=${1:?folder for the results}
shift
failed=()

row() {
    local name=$1 wanted
    shift
    for wanted in "${only[@]}"; do
        [[ $name == "$wanted"* ]] || continue
        printf '\n=== %s\n' "$name"
        "${PROGRAM:-target/release/skiagraph}" "$@" --out "$out/$name" || failed+=("$name")
        return
    done
}

only=("${@:-}")
frame=(--regime-frames 0 --images none)
lists='light_buffer light_buffer@max_entries=65536 light_buffer@max_entries=1'
row hard stress --size 64x64 --map-size 64
row sponza compare rt light_buffer nsm@map_size=2048 nsm@map_size=2048,fit=receivers --scene sponza \
    --size 1920x1080,3840x2160 --frames 51 "${frame[@]}"
row moving compare rt light_buffer nsm crsm crsma_full --scene forest:1000000 --path wind --size 1920x1080 \
    --map-size 1024 --frames 11 --images none
# shellcheck disable=SC2086 # one word for each method
row unlisted compare $lists --scene sponza --size 1920x1080 --frames 21 "${frame[@]}"
row tracer compare rt rt@engine=light_space --scene sponza --size 1920x1080 --frames 51 "${frame[@]}"
row park compare rt light_buffer crsm crsm_depth crsma crsma_full crsm_hw hybrid_pcf --scene park --view all \
    --size 512x512 --map-size 1024 --frames 5 "${frame[@]}"
row lamps compare rt light_buffer nsm --scene lamps --view all --light all --size 512x512 --frames 11 "${frame[@]}"
row area compare rt_area light_buffer_area hybrid_pcf_area pcf --scene park_soft --size 512x512 --frames 5 "${frame[@]}"
row city compare rt light_buffer --scene city:10000000 --view all --size 1920x1080 --frames 7 "${frame[@]}"
row forest compare rt light_buffer --scene forest:10000000 --view overview --size 1920x1080 --frames 7 "${frame[@]}"
[ "${#failed[@]}" -eq 0 ] || { printf 'failed: %s\n' "${failed[*]}" >&2; exit 1; }
