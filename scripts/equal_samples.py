#!/usr/bin/env python3
"""Checks that `light_buffer_area` answers as `rt_area` does, every pixel to the bit.

    scripts/equal_samples.py --foliage FILE.glb --out DIR                 scenes: 11 cells by samples
    scripts/equal_samples.py --generated 100 --size 64x64 --out DIR       generated views and lights
    scripts/equal_samples.py --few --generated 4 --foliage FILE.glb …     one cell of each kind

A cell is a view under a light with an extent, and a number of samples. Three graphs run on it:
`rt_area`; `light_buffer_area`; and the same with lists wherever there are any, in which a receiver
traces its rays if one of its samples was asked of the tracer's own test: this one shows how many
pixels have a sample within the stated bound (docs/light_buffer_area.md), and that the others' are
right. With 16 samples `light_buffer_area` runs twice more, with room for as few entries as a first
frame has: with rays for receivers without a list, and with casters tested for them. Exit 0 if no
pixel differs anywhere and there was penumbra to differ in; 1 if not.

Variables of scripts/mesa25.sh and scripts/swiftshader.sh choose another driver.
"""

import argparse
import re
import struct
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Entries that a first frame has room for; a later one has as many as the frame before needed.
FIRST_FRAME = 65536
ASKED_RAYS = 4

# A sample that the planes do not decide leaves its receiver to rays.
WITHIN = [
    (
        r"return (intersect\(sheared\(ray\), primitive, t_min, &hit\));",
        r"was_asked = true;\n    return \1;",
    ),
    (r"lit == TOO_MANY\);", r"lit == TOO_MANY || was_asked);"),
    (r"^struct Answer", r"var<private> was_asked: bool = false;\n\nstruct Answer"),
]
# Rays are never chosen for all receivers.
NO_RAYS = [(r"if lists > f32\(params\.samples\)", "if lists < 0.0")]
LISTS = """(
    format: 3,
    extends: "light_buffer_area.ron",
    lights: [directional, spot, point],
    set: {"unlisted": rays},
    passes: [
        Change(pass: "weigh.choose_lists", shader: "choose_no_rays"),
        Change(pass: "test_samples", shader: "leave_unsure"),
    ],
)
"""


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--program", type=Path, default=ROOT / "target/debug/skiagraph")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    parser.add_argument("--foliage", type=Path, metavar="FILE.glb", help="mesh of foliage.ron")
    parser.add_argument("--generated", type=int, default=0, metavar="N", help="views, half in park")
    parser.add_argument("--few", action="store_true", help="one cell of each scene")
    parser.add_argument("--only", default="", metavar="TEXT", help="cells with this in their name")
    parser.add_argument("--samples", default="16,64,256", metavar="N,…")
    parser.add_argument("--size", default="128x128", metavar="WxH")
    return parser.parse_args()


def replaced(text, pairs, where):
    for pattern, by in pairs:
        text, count = re.subn(pattern, by, text, flags=re.MULTILINE)
        if count == 0:
            sys.exit(f"{where} has no `{pattern}` any more: change this script with it")
    return text


def write_lists(folder):
    """The document of `light_buffer_area` that shows what lies within the bound."""
    for name, own, pairs in (
        ("test_samples", "leave_unsure", WITHIN),
        ("choose_lists", "choose_no_rays", NO_RAYS),
    ):
        shader = (ROOT / f"shaders/{name}.wgsl").read_text()
        (folder / f"{own}.wgsl").write_text(replaced(shader, pairs, f"{name}.wgsl"))
    (folder / "lists.ron").write_text(LISTS)
    return folder / "lists.ron"


def write_scene(folder, name, pairs):
    """A scene of scenes/ whose lights are given extents."""
    text = replaced((ROOT / f"scenes/{name}.ron").read_text(), pairs, f"{name}.ron")
    file = folder / f"{name}_soft.ron"
    file.write_text(text)
    return str(file)


def scenes(folder, foliage, few):
    """Scene, view, light."""
    views = ["bench", "flowers", "trees", "bench_wide", "flowers_wide", "trees_wide"]
    yield from (("park_soft", view, None) for view in views[: 1 if few else None])
    if foliage:
        masked = write_scene(folder, "foliage", [(r"\(-0\.4, -1, 0\.3\)", r"\g<0>, angle_degrees: 3")])
        (folder / "foliage.glb").write_bytes(foliage.read_bytes())
        yield from ((masked, view, None) for view in ["main", "under"][: 1 if few else None])
    extents = [
        (r"cone_degrees: 110", r"\g<0>, radius: 0.5"),
        (r"position: \(-14, 6, 4\)", r"\g<0>, radius: 0.4"),
        (r"direction: \(0\.744, -0\.408, 0\.527\)", r"\g<0>, angle_degrees: 2"),
    ]
    lamps = write_scene(folder, "lamps", extents)
    yield from ((lamps, "bench", light) for light in (["bulb"] if few else ["lamp", "bulb", "moon"]))


def generated(folder, count):
    for scene, views in (("park", count - count // 2), ("sponza", count // 2)):
        file = folder / f"{scene}_{views}.ron"
        command = ["python3", ROOT / "scripts/generated_views.py", scene, str(views)]
        subprocess.run([*command, "--soft", "--out", file], check=True)
        yield from ((str(file), f"{view:03}", f"light_{view:03}") for view in range(views))


class Runs:
    """Runs graphs on a cell."""

    def __init__(self, args, folder):
        self.program, self.size, self.folder = args.program.resolve(), args.size, folder

    def run(self, graph, cell, samples, *sets):
        """The pixels of `visibility`, as bits, and of `status`."""
        scene, view, light = cell
        files = [self.folder / f"{name}.bin" for name in ("visibility", "status")]
        command = [self.program, "run", graph, "--scene", scene, "--view", view, "--size", self.size]
        command += ["--light", light] if light else []
        for assignment in (f"samples={samples}", *sets):
            command += ["--set", assignment]
        for file in files:
            file.unlink(missing_ok=True)
            command += ["--save", f"{file.stem}={file}"]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        if done.returncode:
            sys.exit(f"{' '.join(map(str, command))}: exit {done.returncode}\n{done.stderr}")
        return [words(file.read_bytes()) for file in files]


def words(content):
    """Numbers of four bytes each."""
    return struct.unpack(f"<{len(content) // 4}I", content)


def differing(one, other):
    return [pixel for pixel, bits in enumerate(zip(one, other)) if bits[0] != bits[1]]


def share(bits):
    return struct.unpack("<f", struct.pack("<I", bits))[0]


def judge(runs, lists, cell, samples):
    """What is wrong in a cell, its pixels in penumbra, and its line."""
    rays, _ = runs.run("rt_area", cell, samples)
    answers, status = runs.run("light_buffer_area", cell, samples)
    sure, sure_status = runs.run(str(lists), cell, samples)
    first = without = None
    if samples == 16:
        few = f"max_entries={FIRST_FRAME}"
        first, _ = runs.run("light_buffer_area", cell, samples, few, "unlisted=rays")
        without, _ = runs.run("light_buffer_area", cell, samples, few, "unlisted=receivers")
    penumbra = sum(0 < share(bits) < 1 for bits in rays)
    asked = sum(value == ASKED_RAYS for value in status)
    within = {pixel for pixel, value in enumerate(sure_status) if value == ASKED_RAYS}
    faults = []
    compared = {"it": answers, "lists and rays": sure, "the first frame": first, "without rays": without}
    for name, seen in compared.items():
        wrong = differing(rays, seen) if seen else []
        if wrong:
            inside = len(within.intersection(wrong))
            faults.append(f"{name}: {len(wrong)} pixels differ, {inside} of them with samples within the bound")
    line = f"{len(rays):,} pixels, {penumbra:,} in penumbra, {asked:,} asked rays, {len(within):,} have "
    first_too = "; the first frame too, with and without rays" if first else ""
    return faults, penumbra, f"{line}a sample within the bound{first_too}"


def main():
    args = arguments()
    args.out.mkdir(parents=True, exist_ok=True)
    folder = args.out.resolve()
    lists, runs = write_lists(folder), Runs(args, folder)
    cells = [] if args.generated and not args.few else list(scenes(folder, args.foliage, args.few))
    cells += generated(folder, args.generated)
    failed, penumbrae = 0, []
    for cell in cells:
        for samples in map(int, args.samples.split(",")):
            scene, view, light = cell
            name = f"{Path(scene).stem} {view}{f', {light}' if light else ''}, {samples} samples"
            if args.only not in name:
                continue
            began = time.monotonic()
            faults, penumbra, line = judge(runs, lists, cell, samples)
            failed += len(faults)
            penumbrae.append(penumbra)
            print(f"{'FAILED' if faults else 'equal '} {name}: {'; '.join([*faults, line])} "
                  f"({time.monotonic() - began:.0f} s)", flush=True)
    soft = sum(map(bool, penumbrae))
    print(
        f"{len(penumbrae)} cells of {args.size}, {soft} of them with penumbra, "
        f"{sum(penumbrae):,} pixels; {failed} faults"
    )
    sys.exit(1 if failed or soft == 0 else 0)


if __name__ == "__main__":
    main()
