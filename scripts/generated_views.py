#!/usr/bin/env python3
"""Writes a scene file with views from anywhere in a scene, each under a light of its own.

    scripts/generated_views.py sponza 200 --seed 1 --out out/sponza_200.ron
    skiagraph compare light_buffer --scene out/sponza_200.ron --view all --images none

Eyes and the points looked at are uniform in a box around what there is to see, lights uniform over
the upper hemisphere; every fifth one is grazing, at most 5 degrees above the horizon. A seed always
gives the same file.
"""

import argparse
import math
import random
import re
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
# Lowest and highest corner of the box.
BOXES = {
    "sponza": ((-1100, 20, -400), (1100, 900, 400)),
    "park": ((-40, 0.5, -35), (105, 40, 40)),
}


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("scene", choices=BOXES)
    parser.add_argument("views", type=int, metavar="N")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--out", type=Path, required=True, metavar="FILE.ron")
    return parser.parse_args()


def vector(numbers):
    return "(" + ", ".join(f"{number:.6f}" for number in numbers) + ")"


def point(random_, box):
    return [random_.uniform(low, high) for low, high in zip(*box)]


def light(random_, grazing):
    """The direction in which it travels."""
    highest = math.sin(math.radians(5)) if grazing else 1
    height = random_.uniform(0.001, highest)
    across, turn = math.sqrt(1 - height * height), random_.uniform(0, math.tau)
    return [across * math.cos(turn), -height, across * math.sin(turn)]


def view(random_, index, box, planes):
    eye, target = point(random_, box), point(random_, box)
    direction = [to - at for at, to in zip(eye, target)]
    return (
        f'(name: "{index:03}", eye: {vector(eye)}, direction: {vector(direction)}, '
        f"fov_y_degrees: {random_.uniform(20, 100):.3f}, {planes}, "
        f"light: (direction: {vector(light(random_, index % 5 == 4))}))"
    )


def main():
    args = arguments()
    text = (ROOT / "scenes" / f"{args.scene}.ron").read_text()
    # Mesh and light, then the clip planes of the first view.
    header = re.search(r"^    mesh: .*?^    light: [^\n]*\n", text, re.DOTALL | re.MULTILINE)[0]
    planes = re.search(r"near: \S+,\s+far: [\d.]+", text)[0]
    planes = " ".join(planes.split())
    random_ = random.Random(args.seed)
    views = [view(random_, index, BOXES[args.scene], planes) for index in range(args.views)]
    args.out.parent.mkdir(parents=True, exist_ok=True)
    args.out.write_text(
        f"// scripts/generated_views.py {args.scene} {args.views} --seed {args.seed}\n"
        f'(\n    format: 1,\n    name: "{args.scene}_{args.views}_views_of_seed_{args.seed}",\n'
        f"{header}    views: [\n        " + ",\n        ".join(views) + ",\n    ],\n)\n"
    )


if __name__ == "__main__":
    main()
