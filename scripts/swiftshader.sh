#!/usr/bin/env bash
# Finds SwiftShader, the software Vulkan driver of Debian's `chromium` package, which moves corners
# to a grid of a sixteenth of a pixel: as coarse as Vulkan allows, and the coarsest that is tested.
# Nothing is installed.
#
#     env $(scripts/swiftshader.sh) skiagraph doctor
#
# prints the variables that pick it, on one line. A folder with `vk_swiftshader_icd.json` may be
# given, else those are looked into where Debian and Chromium's own packages have it.
set -euo pipefail

folders=("$@")
[ $# -gt 0 ] || folders=(/usr/lib/chromium /usr/lib64/chromium /usr/lib/chromium-browser /opt/google/chrome)
for folder in "${folders[@]}"; do
    icd="$folder/vk_swiftshader_icd.json"
    if test -s "$icd" && test -s "$folder/libvk_swiftshader.so"; then
        echo "VK_DRIVER_FILES=$icd VK_ICD_FILENAMES=$icd"
        exit 0
    fi
done
echo "no vk_swiftshader_icd.json with libvk_swiftshader.so in ${folders[*]}: apt-get install chromium (Debian), or name the folder" >&2
exit 1
