#!/usr/bin/env python3
"""Writes a scene file with views from anywhere in a scene, each under a light of its own.

    scripts/generated_views.py sponza 200 --seed 1 --out out/sponza_200.ron
    skiagraph compare light_buffer --scene out/sponza_200.ron --view all --images none

Eyes and the points looked at are uniform in a box around what there is to see, lights uniform over
the upper hemisphere; every fifth one is grazing, at most 5 degrees above the horizon. A seed always
gives the same file.

With --soft the lights have extents, their sizes uniform by logarithm: two suns from 0.1 to 30
degrees wide, a point light and a spot light with radii of 0.0002 to 0.02 of the box's diagonal, and
so on in turn. They are lights of the scene: view 007 is to be seen under light_007.
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
    parser.add_argument("--soft", action="store_true")
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


def soft_light(random_, index, box):
    """A light with an extent."""
    name = f'name: "light_{index:03}"'
    if index % 4 < 2:
        angle = 0.1 * 300 ** random_.random()
        direction = vector(light(random_, index % 5 == 4))
        return f"Directional({name}, direction: {direction}, angle_degrees: {angle:.4f})"
    radius = math.dist(*box) * 2e-4 * 100 ** random_.random()
    place = f"{name}, position: {vector(point(random_, box))}, radius: {radius:.5f}"
    if index % 4 == 2:
        return f"Point({place})"
    axis = vector([random_.gauss(0, 1), -1, random_.gauss(0, 1)])
    return f"Spot({place}, direction: {axis}, cone_degrees: {random_.uniform(60, 160):.2f})"


def view(random_, index, box, planes, own_light):
    eye, target = point(random_, box), point(random_, box)
    direction = [to - at for at, to in zip(eye, target)]
    fov = random_.uniform(20, 100)
    lit = f", light: (direction: {vector(light(random_, index % 5 == 4))})" if own_light else ""
    return (
        f'(name: "{index:03}", eye: {vector(eye)}, direction: {vector(direction)}, '
        f"fov_y_degrees: {fov:.3f}, {planes}{lit})"
    )


def main():
    args = arguments()
    text = (ROOT / "scenes" / f"{args.scene}.ron").read_text()
    # Mesh and light, then the clip planes of the first view.
    header = re.search(r"^    mesh: .*?^    light: [^\n]*\n", text, re.DOTALL | re.MULTILINE)[0]
    planes = re.search(r"near: \S+,\s+far: [\d.]+", text)[0]
    planes = " ".join(planes.split())
    random_ = random.Random(args.seed)
    box, own_light = BOXES[args.scene], not args.soft
    views = [view(random_, index, box, planes, own_light) for index in range(args.views)]
    soft = " --soft" if args.soft else ""
    if args.soft:
        lights = [soft_light(random_, index, box) for index in range(args.views)]
        listed = "    lights: [\n        " + ",\n        ".join(lights) + ",\n    ],\n"
        header = re.sub(r"^    light: [^\n]*\n", lambda _: listed, header, flags=re.MULTILINE)
    args.out.parent.mkdir(parents=True, exist_ok=True)
    args.out.write_text(
        f"// scripts/generated_views.py {args.scene} {args.views} --seed {args.seed}{soft}\n"
        f'(\n    format: 1,\n    name: "{args.scene}_{args.views}_views_of_seed_{args.seed}",\n'
        f"{header}    views: [\n        " + ",\n        ".join(views) + ",\n    ],\n)\n"
    )


if __name__ == "__main__":
    main()
