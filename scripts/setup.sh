#!/usr/bin/env bash
# Makes this machine able to build and run Skiagraph: checks the Rust toolchain, builds the
# program, and installs a software Vulkan driver only where the program itself finds no adapter.
#
#   scripts/setup.sh [--release]     exit 0 ready, 1 the build or the toolchain is wrong, 3 no usable GPU
set -euo pipefail
cd "$(dirname "$0")/.."

debian_packages=(mesa-vulkan-drivers libvulkan1)

say() { printf 'setup: %s\n' "$*" >&2; }

check_toolchain() {
    if ! command -v cargo >/dev/null; then
        if [ -x "$HOME/.cargo/bin/cargo" ]; then
            say "cargo is installed but not in PATH; type:  . \"\$HOME/.cargo/env\"  and run this again"
        else
            say "cargo, Rust's build tool, was not found; install it from https://rustup.rs and run this again"
        fi
        exit 1
    fi
    # A distribution's old cargo stops at the manifest with a message that does not say so.
    local needed found
    needed=$(sed -n 's/^rust-version *= *"\([^"]*\)".*/\1/p' crates/cli/Cargo.toml)
    found=$(cargo --version | cut -d ' ' -f 2)
    if [ "$(printf '%s\n' "$needed" "$found" | sort -V | head -n 1)" != "$needed" ]; then
        say "Skiagraph needs Rust $needed or later, this is $found; type:  rustup update"
        say "(a cargo that came from the distribution cannot do that: install Rust from https://rustup.rs)"
        exit 1
    fi
}

# Asks the program itself, so that script and program never disagree on what a usable adapter is.
# Fails where there is none; any other failure ends the script.
adapter_found() {
    local status=0
    report=$(cargo run --quiet --locked "$@" --bin skiagraph -- doctor 2>&1 </dev/null) || status=$?
    case $status in
        0) return 0 ;;
        3) return 1 ;;
        *)
            printf '%s\n' "$report" >&2
            say "'skiagraph doctor' ended with exit code $status, which is neither 0 (fine) nor 3 (no usable GPU)"
            exit 1
            ;;
    esac
}

give_up() {
    printf '%s\n' "$report" >&2
    say "$1"
    exit 3
}

install_driver() {
    local by_hand="sudo apt-get update && sudo apt-get install ${debian_packages[*]}"
    local as_root=(env DEBIAN_FRONTEND=noninteractive)
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            give_up "no usable GPU, and no sudo to install a software Vulkan driver with; as root, type:  ${by_hand//sudo /}"
        elif sudo -n true 2>/dev/null || [ -t 0 ]; then
            as_root=(sudo "${as_root[@]}")
        else
            give_up "no usable GPU, and sudo wants a password that nobody is here to give; type:  $by_hand"
        fi
    fi
    say "no usable GPU: installing a software Vulkan driver (${debian_packages[*]}) with apt-get"
    local install=("${as_root[@]}" apt-get install -y -qq --no-install-recommends "${debian_packages[@]}")
    # On fresh machines the package lists are missing, on old ones they name packages that are gone:
    # both show as a failed first try.
    if ! "${install[@]}" >/dev/null 2>&1 </dev/null; then
        if ! { "${as_root[@]}" apt-get update -qq && "${install[@]}"; } </dev/null >&2; then
            give_up "apt-get could not install the driver (see above); type:  $by_hand"
        fi
    fi
}

what_to_install() {
    if [ "$(uname -s)" = Darwin ]; then
        echo "Metal is part of macOS; without an adapter this is a virtual machine that hides the GPU: run on the Mac itself"
    elif command -v dnf >/dev/null; then
        echo "type:  sudo dnf install mesa-vulkan-drivers vulkan-loader"
    elif command -v pacman >/dev/null; then
        echo "type:  sudo pacman -S vulkan-swrast vulkan-icd-loader"
    elif command -v zypper >/dev/null; then
        echo "type:  sudo zypper install libvulkan_lvp libvulkan1"
    elif command -v apk >/dev/null; then
        echo "type:  sudo apk add mesa-vulkan-swrast vulkan-loader"
    else
        echo "install the Vulkan loader and a driver; Mesa's lavapipe runs without a GPU (often in a package called mesa-vulkan-drivers)"
    fi
}

check_toolchain
say "building (the first time this takes some minutes)"
cargo build --locked "$@" --bin skiagraph
if adapter_found "$@"; then exit 0; fi
if ! command -v apt-get >/dev/null; then
    give_up "no usable GPU, and this script installs a driver on Debian and Ubuntu only; $(what_to_install)"
fi
install_driver
if ! adapter_found "$@"; then
    give_up "the software Vulkan driver is installed, but Skiagraph still finds no usable adapter (its report is above)"
fi
say "the software Vulkan driver works"
