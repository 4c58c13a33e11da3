#!/usr/bin/env python3
"""Runs methods under Vulkan's validation layer, core and synchronisation, and shows what it says.

    scripts/validation.py PROGRAM [PRESET…] [--size WxH] [--layer LIBRARY]

PROGRAM is skiagraph. Without presets: all of them, under a sun, a spot and a point light, and
`profile` of one for timestamps. Exit 0 if the layer said nothing but what EXPECTED lists, and, where
all presets ran, each of those; 1 if not, or if the layer was not there to say anything.

The layer is taken from Chromium's package, which has a current one; Debian 12's own knows neither
newer rules nor all of Vulkan 1.3.
"""

import argparse
import collections
import json
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

# Messages that are not about anything this program does, by their identifier: whose they are, why.
EXPECTED = {
    "VUID-StandaloneSpirv-None-10684": "naga 30 gives a structure or array the layout of memory "
    "also where a function or a workgroup has it as a variable of its own. Layouts mean nothing "
    "there, and drivers pass over them",
}

LAYERS = [
    "/usr/lib/chromium/libVkLayer_khronos_validation.so",
    "/usr/lib/chromium-browser/libVkLayer_khronos_validation.so",
    # Of other distributions' own packages.
    "/usr/lib64/libVkLayer_khronos_validation.so",
    "/usr/lib/libVkLayer_khronos_validation.so",
]

# What a preset may lack on a software adapter, as the program names it.
MAY_LACK = {"crsm_hw": "CONSERVATIVE_RASTERIZATION"}

ROOT = Path(__file__).resolve().parent.parent

# The park under a spot light, under a point light.
LAMPS = [["--scene", "scenes/lamps.ron", "--light", light] for light in ("lamp", "bulb")]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("program")
    parser.add_argument("presets", nargs="*")
    parser.add_argument("--size", default="64x64")
    parser.add_argument("--layer")
    args = parser.parse_args()
    layer = args.layer or next((path for path in LAYERS if Path(path).exists()), None)
    if layer is None:
        sys.exit(
            "there is no validation layer: install one (Debian: apt-get install chromium), "
            "or name its library by --layer"
        )
    runs = [["run", preset, "--size", args.size] for preset in args.presets or all_presets()]
    if not args.presets:
        runs += [[*run, *lamp] for run in runs for lamp in LAMPS]
        runs.append(["profile", "light_buffer", "--size", args.size, "--frames", "3"])
    said = collections.Counter()
    failed = False
    with tempfile.TemporaryDirectory() as folder:
        manifest(Path(folder), layer)
        for run in runs:
            messages, fault = validated(args.program, run, Path(folder))
            kinds = collections.Counter(kind for kind, _ in messages)
            said += kinds
            new = [message for kind, message in messages if kind not in EXPECTED]
            print(f"{' '.join(run)}: {fault or dict(kinds) or 'nothing'}", flush=True)
            if new:
                print("\n".join(dict.fromkeys(new)))
            failed = failed or bool(new) or (fault is not None and not is_refused(run, fault))
    for kind in sorted(said.keys() & EXPECTED.keys()):
        print(f"expected, {said[kind]} times: {kind}: {EXPECTED[kind]}")
    gone = [] if args.presets else sorted(EXPECTED.keys() - said.keys())
    for kind in gone:
        print(f"said no more, to be taken out of EXPECTED: {kind}")
    unexpected = sum(count for kind, count in said.items() if kind not in EXPECTED)
    print(f"{len(runs)} runs, {sum(said.values())} messages, {unexpected} of them not expected")
    sys.exit(1 if failed or gone else 0)


def all_presets():
    return sorted(path.stem for path in (ROOT / "pipelines").glob("*.ron"))


def is_refused(run, fault):
    """Whether a preset says itself that it does not run on this adapter or under this light."""
    lacks_feature = run[1] in MAY_LACK and MAY_LACK[run[1]] in fault
    takes_no_light = "--light" in run and re.search("takes no (spot|point) light", fault)
    return lacks_feature or bool(takes_no_light)


def manifest(folder, library):
    """What the loader reads of the layer."""
    layer = {
        "name": "VK_LAYER_KHRONOS_validation",
        "type": "GLOBAL",
        "library_path": library,
        "api_version": "1.3.239",
        "implementation_version": "1",
        "description": "validation",
    }
    text = json.dumps({"file_format_version": "1.2.0", "layer": layer})
    (folder / "VkLayer_khronos_validation.json").write_text(text)


def validated(program, arguments, folder):
    """What the layer says of a run: identifiers with texts; and why the run failed, or None."""
    log = folder / "log.txt"
    log.unlink(missing_ok=True)
    environment = os.environ | {
        "VK_LAYER_PATH": str(folder),
        "VK_INSTANCE_LAYERS": "VK_LAYER_KHRONOS_validation",
        "VK_LAYER_LOG_FILENAME": str(log),
        "VK_LAYER_VALIDATE_SYNC": "1",
        "VK_LAYER_DUPLICATE_MESSAGE_LIMIT": "0",
    }
    command = [str(Path(program).resolve()), *arguments]
    ran = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    if not log.exists():
        sys.exit(f"{' '.join(arguments)}: the layer was not loaded:\n{ran.stdout}{ran.stderr}")
    messages = []
    for text in re.split(r"^(?=Validation \w+: \[)", log.read_text(), flags=re.MULTILINE):
        found = re.match(r"Validation \w+: \[ (\S+) \]", text)
        if found:
            messages.append((found[1], text.strip()))
    fault = None
    if ran.returncode != 0:
        told = ran.stderr.strip().splitlines()
        shown = [line.strip() for line in told if "\u00d7" in line] or told
        fault = f"exit {ran.returncode}: {'; '.join(shown)}"
    return messages, fault


if __name__ == "__main__":
    main()
