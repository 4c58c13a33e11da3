#!/usr/bin/env bash
# Unpacks the software adapter of Mesa 25 beside the one of Debian 12: lavapipe with ray queries,
# which Mesa 22.3 has not. Nothing is installed, no root is needed; the packages come from the
# `bookworm-backports` suite of the mirror that apt uses already, checked by Debian's keys.
#
#     env $(scripts/mesa25.sh) skiagraph doctor
#
# prints the variables that pick it, on one line. A folder may be given, else it is target/mesa25;
# what is there already stays.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p "${1:-target/mesa25}"
folder=$(cd "${1:-target/mesa25}" && pwd)
library="$folder/unpacked/usr/lib/$(dpkg --print-architecture | sed 's/amd64/x86_64/; s/arm64/aarch64/')-linux-gnu"
suite=bookworm

fetch() {
    local mirror keys list
    mirror=$(apt-get indextargets --format '$(SITE)' 'Created-By: Packages' "Codename: $suite" | head -n 1)
    test -n "$mirror" || { echo "apt knows no mirror of Debian 12 ($suite): Mesa 25 is fetched from its backports" >&2; exit 1; }
    keys=/usr/share/keyrings/debian-archive-keyring.gpg
    mkdir -p "$folder/lists/partial" "$folder/cache/archives/partial"
    list="$folder/sources.list"
    for of in "$suite" "$suite-backports"; do
        echo "deb [signed-by=$keys] $mirror $of main"
    done >"$list"
    # apt with folders of its own: it resolves what is missing on this machine, and only downloads.
    local apt=(apt-get -qq -o "Dir::Etc::SourceList=$list" -o Dir::Etc::SourceParts=/dev/null
        -o "Dir::State::Lists=$folder/lists" -o "Dir::Cache=$folder/cache" -o Debug::NoLocking=1
        -o APT::Sandbox::User=)
    "${apt[@]}" update >&2
    "${apt[@]}" --yes --download-only --no-install-recommends -t "$suite-backports" install mesa-vulkan-drivers libvulkan1 >&2
    local package
    for package in "$folder"/cache/archives/*.deb; do
        dpkg-deb --extract "$package" "$folder/unpacked"
    done
}

test -e "$library/libvulkan_lvp.so" || fetch
test -e "$library/libvulkan_lvp.so" || { echo "the packages in $folder/cache/archives hold no libvulkan_lvp.so for this machine" >&2; exit 1; }
printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s", "api_version": "1.4.305"}}\n' \
    "$library/libvulkan_lvp.so" >"$folder/lvp_icd.json"
echo "VK_DRIVER_FILES=$folder/lvp_icd.json VK_ICD_FILENAMES=$folder/lvp_icd.json LD_LIBRARY_PATH=$library${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
