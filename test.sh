#!/usr/bin/env bash
# Runs all tests. They create GPU devices, so a machine without any adapter gets a software Vulkan
# driver first. Arguments go to `cargo test`:   ./test.sh -p skiagraph-graph timing
#
# Tests on the real Sponza mesh look for it in $SKIAGRAPH_ASSETS and say so where that is not set.
set -euo pipefail
cd "$(dirname "$0")"

scripts/setup.sh
cargo test --workspace --locked "$@"
