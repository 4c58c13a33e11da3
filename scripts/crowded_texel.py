#!/usr/bin/env python3
"""What `light_buffer` (unlisted=rays) takes where a texel of its grid is crowded, as a share of `rt`.

    scripts/crowded_texel.py                                # a minute on a software adapter
    scripts/crowded_texel.py --size 256x256 --frames 1

100,000 specks hover over the middle of a wide floor, the light straight above them. Seen from
nearby, all receivers are in the texels of the specks; from far away, few are. Grids of 64² texels
and of more, laid over the scene and over the receivers. Writes the mesh, the scene and the results
to --out, and the shares to stdout.
"""

import argparse
import json
import random
import subprocess
import sys
from pathlib import Path

SPECKS = 100_000
SCENE = """(
    format: 1,
    name: "crowded_texel",
    mesh: Obj(file: "crowded_texel.obj"),
    light: (direction: (0.01, -1, 0.02)),
    views: [
        (name: "near", eye: (0.3, 1.2, 0.9), direction: (-0.3, -1.2, -0.9), fov_y_degrees: 50, near: 0.05, far: 100),
        (name: "far", eye: (6, 8, 12), direction: (-6, -8, -12), fov_y_degrees: 50, near: 0.05, far: 100),
    ],
)
"""


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--size", default="512x512", metavar="WxH")
    parser.add_argument("--map-size", default="64,128,256,512", metavar="N,…")
    parser.add_argument("--frames", type=int, default=3, metavar="N", help="timed, after one that is not")
    parser.add_argument("--out", type=Path, default=Path("out/crowded"), metavar="DIR")
    parser.add_argument("--program", metavar="FILE", help="a skiagraph that is built already")
    return parser.parse_args()


def write_scene(folder):
    folder.mkdir(parents=True, exist_ok=True)
    random_ = random.Random(7)
    lines = ["v -30 0 30", "v 30 0 30", "v 30 0 -30", "v -30 0 -30", "f 1 2 3", "f 1 3 4"]
    for speck in range(SPECKS):
        centre = [random_.uniform(-0.3, 0.3), random_.uniform(0.3, 0.7), random_.uniform(-0.3, 0.3)]
        for _ in range(3):
            place = [at + random_.uniform(-0.01, 0.01) for at in centre]
            lines.append("v " + " ".join(f"{at:.6f}" for at in place))
        lines.append("f " + " ".join(str(5 + 3 * speck + corner) for corner in range(3)))
    (folder / "crowded_texel.obj").write_text("\n".join(lines) + "\n")
    (folder / "crowded_texel.ron").write_text(SCENE)


def without_gbuffer(run):
    gbuffer = (step["gpu_ms"]["median"] for step in run["passes"] if step["name"].startswith("gbuffer"))
    return run["frame"]["gpu_ms"]["median"] - sum(gbuffer)


def main():
    args = arguments()
    write_scene(args.out)
    program = [args.program] if args.program else ["cargo", "run", "--quiet", "--release", "--locked", "--bin", "skiagraph", "--"]
    status = subprocess.run([
        *program, "compare", "rt", "light_buffer@unlisted=rays", "--set", f"map_size={args.map_size}", "--set", "fit=scene,receivers",
        "--scene", str(args.out / "crowded_texel.ron"), "--view", "all", "--size", args.size,
        "--frames", str(args.frames), "--warmup", "1", "--regime-frames", "0", "--images", "none",
        "--out", str(args.out / "results"),
    ], stdout=subprocess.DEVNULL).returncode  # fmt: skip
    if status:
        return status
    runs = json.loads((args.out / "results" / "results.json").read_text())["runs"]
    rays = {run["view"]: without_gbuffer(run) for run in runs if run["preset"] == "rt"}
    print("| view | fit | grid | ms | of `rt` | uncertain % | wrong outside the band |")
    print("|---|---|---|---|---|---|---|")
    for run in runs:
        if run["preset"] != "rt":
            took, params = without_gbuffer(run), run["params"]
            print(
                f"| {run['view']} | `{params['fit']}` | {params['map_size']}² | {took:.1f} | "
                f"{took / rays[run['view']]:.2f} | {100 * run['uncertain'] / run['pixels']['facing_light']:.1f} | "
                f"{run['wrong']['total'] - run['wrong']['in_band']} |"
            )
    return 0


if __name__ == "__main__":
    sys.exit(main())
