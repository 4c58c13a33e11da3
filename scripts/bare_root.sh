#!/usr/bin/env bash
# Runs adapter.sh of a bundle where there is nothing else: in a root folder with a shell, a C library
# and one driver, without compiler, registry, network or this repository. Needs root, and unshare.
#
#     scripts/bare_root.sh ROOT BUNDLE mesa [WORD…]           llvmpipe, as this machine has it
#     scripts/bare_root.sh ROOT BUNDLE swiftshader [WORD…]    Chromium's, by scripts/swiftshader.sh
#
# ROOT is made anew, but for ROOT/out; the rows are in ROOT/out/mesa or ROOT/out/swiftshader. The
# words go to adapter.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
[ $# -ge 3 ] || { echo "usage: scripts/bare_root.sh ROOT BUNDLE mesa|swiftshader [WORD…]" >&2; exit 2; }
root=$1 bundle=$2 driver=$3
shift 3

case $driver in
    mesa)
        icd=$(find /usr/share/vulkan/icd.d /etc/vulkan/icd.d -name 'lvp_icd*.json' 2>/dev/null | head -n 1)
        test -n "$icd" || { echo "no llvmpipe here: apt-get install mesa-vulkan-drivers" >&2; exit 1; }
        library=$(ldconfig -p | sed -n 's/.*libvulkan_lvp\.so .*=> //p' | head -n 1)
        library=${library:-$(find /usr/lib -name libvulkan_lvp.so | head -n 1)}
        ;;
    swiftshader)
        icd=$(scripts/swiftshader.sh)
        icd=${icd##*=}
        library=$(dirname "$icd")/libvk_swiftshader.so
        ;;
    *) echo "no driver $driver; there are mesa and swiftshader" >&2; exit 2 ;;
esac
loader=$(ldconfig -p | sed -n 's/.*libvulkan\.so\.1 .*=> //p' | head -n 1)
test -n "$loader" || { echo "no Vulkan loader here: apt-get install libvulkan1" >&2; exit 1; }

mkdir -p "$root/out"
find "$root" -mindepth 1 -maxdepth 1 ! -name out -exec rm -rf {} +
mkdir -p "$root/proc" "$root/tmp" "$root/dev" "$root/bundle"
cp -r "$bundle/." "$root/bundle/"
for folder in bin lib lib64; do # as here, where these are links
    test ! -L "/$folder" || { mkdir -p "$root/usr/$folder"; ln -s "usr/$folder" "$root/$folder"; }
done
# Programs and libraries with all that they are linked with, each at its own place.
linked() { ldd "$@" 2>/dev/null | sed -n 's/^[^/]*\(\/[^ :]*\)\( (.*\)$/\1/p'; }
files=(/bin/sh "$library" "$loader")
for tool in cat cksum cp date dirname grep mkdir mv rm sed sleep; do files+=("$(type -P "$tool")"); done
{ printf '%s\n' "${files[@]}"; linked "${files[@]}" "$bundle/skiagraph"; } | sort -u |
    while read -r file; do
        mkdir -p "$root$(dirname "$file")"
        cp -L "$file" "$root$file"
    done
mkdir -p "$root$(dirname "$icd")"
cp "$icd" "$root$icd"
mknod -m 666 "$root/dev/null" c 1 3 2>/dev/null || : >"$root/dev/null"

exec unshare --net --mount --pid --fork --mount-proc="$root/proc" \
    env -i VK_DRIVER_FILES="$icd" VK_ICD_FILENAMES="$icd" PATH=/bin:/usr/bin \
    "$(type -P chroot)" "$root" /bin/sh /bundle/adapter.sh --out "/out/$driver" "$@"
