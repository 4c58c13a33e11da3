#!/usr/bin/env bash
# Runs all tests. They create GPU devices, so a machine without any adapter gets a software Vulkan
# driver first. Arguments go to `cargo test`:   ./test.sh -p skiagraph-graph timing
#
# A test opens `report.html` in Chromium: `chromium`, or what $CHROMIUM names.
#
# Tests on the meshes of Sponza and bench look for them in $SKIAGRAPH_ASSETS and say so where that is
# not set.
set -euo pipefail
cd "$(dirname "$0")"
# Without a session (a container, say) Mesa asks for this folder and complains on stderr.
export XDG_RUNTIME_DIR="${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}"

scripts/setup.sh
if ! command -v "${CHROMIUM:-chromium}" >/dev/null; then
    echo "test.sh: there is no ${CHROMIUM:-chromium}; one test opens the report in it and will fail (Debian: apt-get install chromium)" >&2
fi
cargo test --workspace --locked "$@"
