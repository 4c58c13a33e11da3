#!/usr/bin/env bash
# Runs the tests. They create GPU devices, so a machine without any adapter gets a software Vulkan
# driver first, and a browser in which one test opens `report.html` (`chromium`, or the program that
# $CHROMIUM names; Debian's package of it holds the validation layer that another test asks).
# Another test tries the page with axe-core, where `npm ci --prefix crates/cli/tests/axe` has put it.
# Arguments go to `cargo test`:
#
#   ./test.sh                          all tests but the suites that take minutes
#   ./test.sh --all                    these, too
#   ./test.sh --test graph extends::   some of one binary: graph, gpu, scene, draw, chart,
#                                      reference, compare, cli, or across (those of tests/)
#
# Tests on the meshes of Sponza and bench look for them in $SKIAGRAPH_ASSETS and say so where that is
# not set.
set -euo pipefail
cd "$(dirname "$0")"
# Without a session (a container, say) Mesa asks for this folder and complains on stderr.
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}"

all=''
if [ "${1:-}" = --all ]; then
    all=yes
    shift
fi
# Some tests alone need not wait for the build of all.
if [ $# -eq 0 ] || [ ! -x "${CARGO_TARGET_DIR:-target}/debug/skiagraph" ]; then
    scripts/setup.sh test >/dev/null
fi
if [ -z "$all" ]; then
    cargo test --workspace --locked "$@"
else
    # The others have steps of their own: ray queries need another adapter, `ci_long_` takes longer still.
    cargo test --workspace --locked "$@" -- --include-ignored --skip ray_query --skip moving_rays:: --skip ci_long_
fi
