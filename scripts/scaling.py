#!/usr/bin/env python3
"""How methods grow with the number of triangles: compares them on the generated scenes `city` and
`forest` from 10,000 to 10,000,000 triangles, and writes what docs/scaling.md is made of.

    scripts/scaling.py                                      # hours on a software adapter
    scripts/scaling.py rt nsm --sizes 10000,100000 --viewport 640x360 --frames 1
    scripts/scaling.py --sizes 1000000 --viewport 960x540,3840x2160 --map-size 1024,8192 --frames 1

Every scene and size has a folder of its own below --out, with its results.json; what is there
already is kept (`compare --resume`), so that an interrupted run goes on where it stopped. After
each, all that is there is written anew to scaling.csv, scaling.svg and scaling.md.
"""

import argparse
import csv
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SCENES = ["city", "forest"]


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("methods", nargs="*", metavar="METHOD", help="as `skiagraph compare` takes them")
    sizes = [10_000, 100_000, 1_000_000, 10_000_000]
    parser.add_argument("--sizes", type=integers, default=sizes, metavar="N,…")
    parser.add_argument("--scenes", type=lambda text: text.split(","), default=SCENES, metavar="NAME,…")
    parser.add_argument("--view", default="overview", help="a view of the scenes, or all")
    parser.add_argument("--viewport", default="1920x1080", metavar="WxH,…")
    parser.add_argument("--map-size", type=integers, default=[2048], metavar="N,…", help="where no method is named")
    parser.add_argument("--frames", type=int, default=5, metavar="N", help="timed, after one that is not")
    parser.add_argument("--out", type=Path, default=Path("out/scaling"), metavar="DIR")
    parser.add_argument("--program", metavar="FILE", help="a skiagraph that is built already")
    return parser.parse_args()


def integers(text):
    return [int(number.replace("_", "")) for number in text.split(",")]


def skiagraph(args, *words):
    """Runs the program; what it prints as a table is not wanted here."""
    program = [args.program] if args.program else ["cargo", "run", "--quiet", "--release", "--locked", "--bin", "skiagraph", "--"]
    print("skiagraph", *words, flush=True)
    return subprocess.run([*program, *map(str, words)], stdout=subprocess.DEVNULL).returncode


def compare(args, scene, triangles, folder):
    # light_buffer chooses its grid, too.
    mapped = ["nsm", "crsma_full"] + (["light_buffer"] if len(args.map_size) > 1 else [])
    with_maps = [f"{name}@map_size={size}" for name in mapped for size in args.map_size]
    methods = args.methods or ["rt", *with_maps, "light_buffer"]
    return skiagraph(
        args, "compare", *methods, "--scene", f"{scene}:{triangles}", "--view", args.view,
        "--size", args.viewport, "--frames", args.frames, "--warmup", 1,
        "--regime-frames", 0, "--images", "none", "--timeout", 3600, "--resume", "--out", folder,
    )  # fmt: skip


def rows(folders):
    found = []
    for folder in folders:
        with open(folder / "results.csv", newline="") as file:
            found += csv.DictReader(file)
    return found


def number(cell, digits=0):
    return f"{float(cell):,.{digits}f}" if cell else "–"


def time(row):
    """The frame less its G-buffer, ms; empty where there are no GPU times."""
    return float(row["gpu_ms"]) - float(row["gbuffer_gpu_ms"] or 0) if row["gpu_ms"] else ""


def place(row):
    return tuple(row[column] for column in ("scene", "triangles", "view", "width", "height"))


def table(found):
    """A line per method and map; the times of `rt` on the same scene, view and viewport stand for 1."""
    rt = {place(row): time(row) for row in found if row["preset"] == "rt"}
    lines = [
        "| scene | triangles | view | pixels | method | map | ms less G-buffer | of `rt` | G-buffer ms | MB graph | MB scene | wrong % | in band % | uncertain % |",
        "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in found:
        where = place(row)
        cells = [row["scene"], number(row["triangles"]), row["view"], f"{row['width']}×{row['height']}"]
        cells += [f"`{row['preset']}`", row["map_size"] or "–"]
        if row["unavailable"]:
            lines.append("| " + " | ".join([*cells, row["unavailable"].replace("|", "/")]) + " | | | | | | | |")
            continue
        facing = max(1, int(row["facing_light"]))
        ratio = time(row) / rt[where] if rt.get(where) and time(row) else ""
        share = lambda column: f"{100 * int(row[column]) / facing:.3g}"
        cells += [number(time(row), 1), number(ratio, 2), number(row["gbuffer_gpu_ms"], 1)]
        cells += [number(float(row[column]) / 1e6, 1) for column in ("memory_bytes", "scene_bytes")]
        outside = int(row["wrong_total"]) - int(row["wrong_in_band"])
        cells += [f"{100 * outside / facing:.3g}", share("band"), share("uncertain")]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def write(args, folders):
    """Everything from what is there; each file is replaced whole."""
    found = rows(folders)
    files = {"scaling.md": table(found)}
    with open(args.out / "scaling.csv.part", "w", newline="") as file:
        lines = csv.DictWriter(file, found[0].keys())
        lines.writeheader()
        lines.writerows(found)
    os.replace(args.out / "scaling.csv.part", args.out / "scaling.csv")
    for name, text in files.items():
        (args.out / f"{name}.part").write_text(text)
        os.replace(args.out / f"{name}.part", args.out / name)
    if "," in args.viewport or len(args.map_size) > 1:
        return 0  # The chart is that of triangles.
    return skiagraph(args, "chart", *folders, "--kind", "growth", "--out", args.out / "scaling.svg")


def main():
    args = arguments()
    os.chdir(ROOT)
    args.out.mkdir(parents=True, exist_ok=True)
    done, failed = [], []
    # Small ones first: a run that is stopped early has seen every scene.
    for triangles in sorted(args.sizes):
        for scene in args.scenes:
            folder = args.out / f"{scene}-{triangles}"
            status = compare(args, scene, triangles, folder)
            if (folder / "results.csv").is_file():
                done.append(folder)
                failed += ["chart"] if write(args, done) != 0 else []
            if status == 130:
                sys.exit("stopped; the same command goes on from there")
            if status != 0:
                failed.append(f"{scene}:{triangles} (exit {status})")
    print(f"scaling.csv, scaling.svg and scaling.md are in {args.out}")
    if failed:
        sys.exit("failed: " + ", ".join(failed))


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        sys.exit("stopped; the same command goes on from there")
