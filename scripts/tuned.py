#!/usr/bin/env python3
"""Holds `compare --tune` against a full grid: `scripts/tuned.py [LEVEL…] --out DIR`, exit 0 fine, 1 not.

On each level every method is tuned, and then measured in every combination of the values that its
document marks with `tune`, on the views that the tuned one was judged on. Fails where a tuned method
is wrong on more than 1.2 times as many pixels as the best of the grid, and on more than 0.05 % of
the pixels that face the light beyond it, or where the verdict recommends a setting that another one
beats. Two levels are made here: `room`, a living room of one-sided walls and sheets, and `hedge`, leaves of
single quads under the open sky. 
"""

import argparse
import itertools
import json
import math
import random
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "target/debug/skiagraph"
LEVELS = ["sponza", "bench", "park", "level", "avenue", "lamps", "room", "hedge"]
# The params of each method that are searched and have an effect with its others.
PARAMS = {
    "nsm": ["cull", "fit", "slope_bias", "bias"],
    "pssm": ["cull", "slope_bias", "bias", "split_lambda", "fit_to_receivers", "normal_offset"],
    "pcf": ["cull", "fit", "slope_bias", "bias"],
}
# Most settings that one command compares: each keeps its resources, for frames in turns.
AT_ONCE = 200
TIMES, POINTS = 1.2, 0.0005


def quad(corners, faces, points):
    first = len(points) + 1
    points.extend(corners)
    faces.append((first, first + 1, first + 2))
    faces.append((first, first + 2, first + 3))


def box(low, high, points, faces, inward=False, without=()):
    (a, b, c), (d, e, f) = low, high
    sides = {
        "left": [(a, b, c), (a, b, f), (a, e, f), (a, e, c)],
        "right": [(d, b, f), (d, b, c), (d, e, c), (d, e, f)],
        "floor": [(a, b, c), (d, b, c), (d, b, f), (a, b, f)],
        "ceiling": [(a, e, f), (d, e, f), (d, e, c), (a, e, c)],
        "back": [(d, b, c), (a, b, c), (a, e, c), (d, e, c)],
        "front": [(a, b, f), (d, b, f), (d, e, f), (a, e, f)],
    }
    for name, corners in sides.items():
        if name not in without:
            quad(corners[::-1] if inward else corners, faces=faces, points=points)


def room():
    """Walls that are seen from inside alone, a window to the sun, and furniture."""
    points, faces = [], []
    box((-4, 0, -3), (4, 2.8, 3), points, faces, inward=True, without=("front",))
    # The wall with the window: four parts around it, looking inwards.
    for low, high in [((-4, 0), (-2, 2.8)), ((2, 0), (4, 2.8)), ((-2, 0), (2, 0.9)), ((-2, 2.3), (2, 2.8))]:
        (a, b), (d, e) = low, high
        quad([(d, b, 3), (a, b, 3), (a, e, 3), (d, e, 3)], faces, points)
    for x in (-1, 0, 1):
        box((x - 0.04, 0.9, 2.96), (x + 0.04, 2.3, 3.04), points, faces)
    # Sheets whose only side is turned to the light: a curtain, a table, and boards of a shelf.
    quad([(-2, 0.9, 2.95), (-0.4, 0.9, 2.95), (-0.4, 2.3, 2.95), (-2, 2.3, 2.95)], faces, points)
    quad([(-1.2, 0.78, 0.6), (1.2, 0.78, 0.6), (1.2, 0.78, -0.6), (-1.2, 0.78, -0.6)], faces, points)
    for y in (0.5, 1.0, 1.5):
        quad([(-3.9, y, 1), (-3.3, y, 1), (-3.3, y, -1.5), (-3.9, y, -1.5)], faces, points)
    for x, z in itertools.product((-1.1, 1.05), (-0.5, 0.45)):
        box((x, 0, z), (x + 0.05, 0.7, z + 0.05), points, faces)
    box((-3.8, 0, -2.8), (-2.8, 1.9, -2.2), points, faces)
    box((2.2, 0, -2.6), (3.8, 0.45, -0.6), points, faces)
    return points, faces


def hedge():
    """A ground, a wall and 3,000 leaves of one quad each."""
    points, faces = [], []
    chance = random.Random(7)
    box((-20, -0.5, -20), (20, 0, 20), points, faces)
    box((-8, 0, -6), (8, 3, -5.6), points, faces)
    for _ in range(3000):
        centre = [chance.uniform(-9, 9), chance.uniform(0.3, 2.5), chance.gauss(1, 0.5)]
        turn, tilt = chance.uniform(0, math.tau), chance.uniform(-1.2, 1.2)
        across = [math.cos(turn), 0, math.sin(turn)]
        up = [-math.sin(turn) * math.sin(tilt), math.cos(tilt), math.cos(turn) * math.sin(tilt)]
        wide, high = chance.uniform(0.05, 0.12), chance.uniform(0.08, 0.2)
        corners = [(-wide, -high), (wide, -high), (wide, high), (-wide, high)]
        quad([tuple(c + a * x + b * y for c, a, b in zip(centre, across, up)) for x, y in corners], faces, points)
    return points, faces


def scene(level, folder):
    """The arguments that name a level."""
    if level not in ("room", "hedge"):
        return ["--scene", level]
    points, faces = {"room": room, "hedge": hedge}[level]()
    file = folder / f"{level}.obj"
    lines = ["v " + " ".join(f"{number:.5f}" for number in point) for point in points]
    lines += ["f " + " ".join(map(str, face)) for face in faces]
    file.write_text("\n".join(lines) + "\n")
    look = {"room": ["--eye", "-3.4,1.6,-2.4", "--look", "0.8,-0.25,0.65"], "hedge": ["--eye", "6,2.4,8", "--look", "-0.6,-0.3,-0.8"]}
    return ["--scene", str(file), "--light", "-0.35,-0.55,-0.75", *look[level]]


def compare(program, arguments, out, *flags):
    """The runs of a comparison, and what it said."""
    command = [str(program), "compare", *arguments, "--images", "none", "--replace", "--out", str(out), *flags]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
    return json.loads((out / "results.json").read_text())["runs"], done.stdout


def shares(runs):
    """Wrong share of each method over all views, outside the band."""
    sums = {}
    for run in runs:
        if "wrong" in run:
            of = sums.setdefault(run["preset"], [0, 0])
            of[0] += run["wrong"]["total"] - run["wrong"]["in_band"]
            of[1] += run["pixels"]["facing_light"]
    return {name: wrong / max(facing, 1) for name, (wrong, facing) in sums.items()}


def marked(program):
    """Values to tune of each param of each method, as `presets` lists them."""
    text = subprocess.run([str(program), "presets"], capture_output=True, text=True, check=True).stdout
    values, method = {}, None
    for line in text.splitlines():
        if head := re.match(r"(\w+): ", line):
            method = head[1]
        elif found := re.match(r"  --set (\w+)=.*; tune: (.*)", line):
            values[method, found[1]] = found[2].split(", ")
    return values


def grid(program, method, values, views, where, out, size):
    """Wrong share of each combination, over all views."""
    params = [param for param in PARAMS[method] if (method, param) in values]
    names = itertools.product(*(values[method, param] for param in params))
    names = [method + "@" + ",".join(f"{param}={value}" for param, value in zip(params, of)) for of in names]
    runs = []
    for view in views:
        for first in range(0, len(names), AT_ONCE):
            which = [] if view is None else ["--view", view]
            few = ["--size", size, "--frames", "1", "--warmup", "0", "--regime-frames", "0"]
            runs += compare(program, [*names[first : first + AT_ONCE], *where, *which], out, *few)[0]
    return shares(runs)


def check(program, level, methods, values, size, folder):
    where = scene(level, folder)
    own = level in ("room", "hedge")
    every = [] if own or level in ("sponza", "lamps") else ["--view", "all"]
    runs, said = compare(program, [*methods, *where, *every], folder / level, "--tune", "--size", size)
    views = [None] if own else sorted({run["view"] for run in runs})
    found, fine = shares(runs), True
    for method in methods:
        record = next((run["tuned"] for run in runs if run.get("tuned", {}).get("of") == method), None)
        if record is None:
            # Splits, for example, are of directional lights alone.
            why = next((run["unavailable"] for run in runs if run["preset"] == method and "unavailable" in run), None)
            fine &= why is not None
            print(f"| {level} | {method} | {why or 'NOT TUNED'} | | | | | | |", flush=True)
            continue
        name = next(run["preset"] for run in runs if run.get("tuned") == record)
        all_shares = grid(program, method, values, views, where, folder / f"{level}-grid", size)
        best = min(all_shares, key=all_shares.get)
        is_near = found[name] <= max(TIMES * all_shares[best], all_shares[best] + POINTS)
        # The verdict names no default that its tuned self beats.
        first = said[said.find("╘") :]
        advised = re.findall(r"`([^`]+)`", first.split("Tuned settings")[0])
        agrees = found[name] >= found[method] or not any(a.split(" ")[0] == method for a in advised)
        fine &= is_near and agrees
        print(
            f"| {level} | {method} | {found[method]:.3%} | {found[name]:.3%} | {all_shares[best]:.3%} | {record['tried']} of {len(all_shares)}"
            f" | {', '.join(f'{key}={value}' for key, value in record['set'].items()) or 'defaults'} | {best.split('@')[1]} | {'yes' if is_near and agrees else 'NO'} |",
            flush=True,
        )
    return fine


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("levels", nargs="*", default=LEVELS, metavar="LEVEL")
    parser.add_argument("--methods", nargs="+", default=list(PARAMS), choices=PARAMS)
    parser.add_argument("--size", default="128x128", metavar="WxH")
    parser.add_argument("--program", type=Path, default=PROGRAM)
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    args = parser.parse_args()
    args.out.mkdir(parents=True, exist_ok=True)
    values = marked(args.program)
    print("| level | method | defaults | tuned | best of the grid | settings tried | tuned to | best setting | near and said |")
    print("|---|---|---:|---:|---:|---:|---|---|---|", flush=True)
    fine = [check(args.program, level, args.methods, values, args.size, args.out) for level in args.levels]
    return 0 if all(fine) else 1


if __name__ == "__main__":
    sys.exit(main())
