#!/usr/bin/env bash
# Makes this machine able to build and run Skiagraph: checks the Rust toolchain, builds the
# program, installs a software Vulkan driver only where the program itself finds no adapter, and
# prints where the program is.
#
#   scripts/setup.sh release   the program that `./run.sh` starts: without the window
#   scripts/setup.sh dev       the program as the tests build it
#   scripts/setup.sh test      the tests, too, and the browser that one of them starts
#
# Exit 0 ready, 1 the build or the toolchain is wrong, 3 no usable GPU.
set -euo pipefail
cd "$(dirname "$0")/.."

kind=${1:-release}
target=${CARGO_TARGET_DIR:-$PWD/target}
# One set of features for tests, examples and the program, or dependencies were built twice.
case $kind in
    release) program=$target/release/skiagraph build=(build --release -p skiagraph --no-default-features --bin skiagraph) ;;
    dev | test) program=$target/debug/skiagraph build=(test --workspace --no-run) ;;
    *) printf 'setup: no kind %s; there are release, dev and test\n' "$kind" >&2 && exit 1 ;;
esac

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

# Asks the program itself, so that script and program never disagree on which adapter is usable.
# Fails where there is none; any other failure ends the script.
adapter_found() {
    local status=0
    report=$("$program" doctor 2>&1 </dev/null) || status=$?
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

report=''
give_up() {
    [ -z "$report" ] || printf '%s\n' "$report" >&2
    say "$1"
    exit 3
}

# Installs Debian packages: why they are needed, then their names. Without the right to, ends the
# script with the command to type.
install() {
    local why=$1
    shift
    local by_hand="sudo apt-get update && sudo apt-get install $*"
    local as_root=(env DEBIAN_FRONTEND=noninteractive)
    if [ "$(id -u)" -ne 0 ]; then
        if ! command -v sudo >/dev/null; then
            give_up "$why, and there is no sudo to install with; as root, type:  ${by_hand//sudo /}"
        elif sudo -n true 2>/dev/null || [ -t 0 ]; then
            as_root=(sudo "${as_root[@]}")
        else
            give_up "$why, and sudo asks for a password; type:  $by_hand"
        fi
    fi
    say "$why: installing $* with apt-get"
    local install=("${as_root[@]}" apt-get install -y -qq --no-install-recommends "$@")
    # On fresh machines the package lists are missing, on old ones they name packages that are gone:
    # both show as a failed first try.
    if ! "${install[@]}" >/dev/null 2>&1 </dev/null; then
        if ! { "${as_root[@]}" apt-get update -qq && "${install[@]}"; } </dev/null >&2; then
            give_up "apt-get could not install $* (see above); type:  $by_hand"
        fi
    fi
}

# Before anything is built, so that a missing right to install is told at once.
install_early() {
    local browser=${CHROMIUM:-chromium}
    if [ "$kind" = test ] && ! command -v "$browser" >/dev/null; then
        if [ -n "${CHROMIUM:-}" ] || ! command -v apt-get >/dev/null; then
            give_up "a test opens the report in a browser, and there is no $browser; install Chromium, or name it in \$CHROMIUM"
        fi
        install "a test opens the report in a browser, and there is no $browser" chromium
    fi
    if command -v apt-get >/dev/null && command -v ldconfig >/dev/null && ! ldconfig -p | grep -q 'libvulkan\.so\.1'; then
        install "there is no Vulkan loader, so no adapter" "${debian_packages[@]}"
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
install_early
say "building (the first time this takes some minutes)"
cargo "${build[@]}" --locked >&2
if ! adapter_found; then
    if ! command -v apt-get >/dev/null; then
        give_up "no usable GPU, and this script installs a driver on Debian and Ubuntu only; $(what_to_install)"
    fi
    install "no usable GPU" "${debian_packages[@]}"
    if ! adapter_found; then
        give_up "the software Vulkan driver is installed, but Skiagraph still finds no usable adapter (its report is above)"
    fi
    say "the software Vulkan driver works"
fi
echo "$program"
