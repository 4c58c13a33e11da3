#!/usr/bin/env python3
"""Draws published figures beside those of `skiagraph compare`: theirs left, ours right, on the same axes.

    skiagraph compare rt nsm_d --scene sponza --size 512x512 --map-size 512,1024 --out sponza
    /usr/bin/python3 scripts/published_charts.py sponza --beside D:docs/data/dissertation.csv --out charts

Draws a chart of each share, time and rate that both sides have, by map size and by viewport. Times
of two machines have no axis in common: those of methods with a map are shares of the sum of steps of
the method without a map in the same view and viewport, and rates of its rate; its own sums are drawn
against pixels. Figures of one side alone are named on standard error, with the reason. Reads
results.csv, and times of steps from the results.json beside it, if there is one.
"""

import argparse
import csv
import json
import math
import os
import re
import sys
import textwrap
from collections import namedtuple
from pathlib import Path

try:
    from matplotlib import pyplot
except ImportError:
    sys.exit("no matplotlib: apt-get install python3-matplotlib, and run this by /usr/bin/python3")

SUM = "ms.steps"
# Okabe and Ito's palette; hatches tell bars apart without colours, too.
COLOURS = ["#0072B2", "#E69F00", "#009E73", "#CC79A7", "#D55E00", "#56B4E9", "#555555", "#F0E442"]
HATCHES = ["", "//", "..", "\\\\", "xx", "--", "oo", "++"]
GROUPS = {"map": "map sizes", "viewport": "viewports"}
NO_TWO = "no two {} of which there are figures on both sides"
# Without a map, its size is 0.
Key = namedtuple("Key", "scene view viewport map method")


def arguments():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR", help="of `compare --out`")
    parser.add_argument("--beside", required=True, metavar="LABEL:FILE.csv", help="as for `compare`")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR")
    return parser.parse_args()


def size(pixels):
    return "{}x{}".format(*pixels) if isinstance(pixels, tuple) else f"{pixels}²"


def read_published(file):
    """Returns the keys of each line, one for each method that it names, and its columns."""
    lines = []
    with open(file, newline="") as rows:
        for row in csv.DictReader(rows):
            width, height = map(int, row["viewport"].split("x"))
            place = row["scene"], row["view"], (width, height), int(row["map_size"] or 0)
            lines.append(([Key(*place, method) for method in row["preset"].split()], row))
    return lines


def read_measured(folder):
    """Returns the key and columns of each row of results.csv, with its passes of results.json."""
    with open(folder / "results.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    runs = [{}] * len(rows)
    if (folder / "results.json").is_file():
        kept = json.loads((folder / "results.json").read_text())
        runs = [run for part in [kept, *kept.get("others", [])] for run in part["runs"]]
    for row, run in zip(rows, runs):
        place = row["scene"], row["view"], (int(row["width"]), int(row["height"]))
        key = Key(*place, int(row["map_size"] or 0), row["preset"])
        yield key, row | {"passes": run.get("passes", [])}


def our_figures(row):
    """Returns the figures of a run under the names of published ones."""
    count = lambda *columns: sum(int(row[column] or 0) for column in columns)
    facing, moved = count("facing_light"), count("wrong_lit") - count("wrong_shadow")
    shares = {
        "wrong": (count("wrong_total"), facing),
        "wrong_lit": (count("wrong_lit"), count("lit") + moved),
        "wrong_shadow": (count("wrong_shadow"), count("shadow") - moved),
        "uncertain": (count("uncertain"), facing),
        "certain_right": (count("lit_certain_right", "shadow_certain_right"), facing),
        "certain_wrong": (count("lit_certain_wrong", "shadow_certain_wrong"), facing),
    }
    figures = {f"{name}_percent": 100 * part / max(of, 1) for name, (part, of) in shares.items()}
    if row["gpu_ms"]:
        figures |= {"ms.frame": float(row["gpu_ms"]), "fps": 1000 / float(row["gpu_ms"])}
    for step in row["passes"]:
        # The step `trace_rays` has the passes `trace_rays.inner` and `turn[0].trace_rays`.
        parts = step["name"].split(".")
        name = next((part for part in parts if not part.endswith("]")), step["name"])
        ms = step["gpu_ms"]["median"] if step.get("gpu_ms") else math.nan
        for quantity in (f"ms.{name}", SUM):
            figures[quantity] = figures.get(quantity, 0) + ms
    return figures


def pair(run, quantity):
    """Returns the published figure of a run and ours; None if one of them is unknown."""
    theirs, ours = run
    if quantity not in theirs:
        return None
    steps = quantity[3:].split("+") if quantity.startswith("ms.") else []
    names = [f"ms.{step}" for step in steps] or [quantity]
    measured = sum(ours.get(name, math.nan) for name in names)
    return (float(theirs[quantity]["value"]), measured) if math.isfinite(measured) else None


def without_counterpart(runs, lines, label):
    """Says which scenes, views, viewports, maps and methods are only measured or only published."""
    ours, theirs = {}, {}
    for key in runs:
        ours.setdefault(key.scene, []).append(key)
    for keys, row in lines:
        methods = {key.method for key in ours.get(row["scene"], [])}
        # One of several methods is enough.
        chosen = [key for key in keys if key.method in methods] or keys[:1]
        theirs.setdefault(row["scene"], []).extend(chosen)
    for whose, own, other, why in [
        ("our", ours, theirs, f"{label} has no figures"),
        (f"{label}'s", theirs, ours, "no results"),
    ]:
        for scene, keys in own.items():
            if words := lacking(keys, other[scene]) if scene in other else "all of it":
                yield f"not drawn, of {whose} {scene}: {words}: {why}"



def lacking(keys, others):
    """Lists the views, viewports, map sizes and methods of `keys` that `others` do not have."""
    words = []
    for kind, text in [("view", str), ("viewport", size), ("map", size), ("method", str)]:
        has, there = ({getattr(key, kind) for key in each} for each in (keys, others))
        if more := sorted(has - there - {0}):
            words.append(f"{kind} {', '.join(map(text, more))}")
    return "; ".join(words)


def head(quantity):
    if quantity.endswith("_percent"):
        return quantity.removesuffix("_percent").replace("_", " ") + ", %"
    return {SUM: "sum of steps, ms", "fps": "fps"}.get(quantity) or quantity[3:] + ", ms"


def bars(runs, quantity):
    """Returns the label of the axis, and both values of each run that has them."""
    whole = "fps" if quantity == "fps" else SUM if quantity.startswith("ms.") else None
    label, pairs, bases = head(quantity), {}, {}
    if whole:
        wholes = [(key, pair(run, whole)) for key, run in runs.items() if not key.map]
        bases = {key[:3]: (key.method, base) for key, base in wholes if base and all(base)}
        methods = " or ".join(sorted({method for method, _ in bases.values()}))
        label = f"{label}\nas % of {methods}'s {head(whole)}" if bases else None
    for key, run in runs.items():
        method, base = bases.get(key[:3], (None, None)) if whole else (None, (100, 100))
        # The whole is 100 % of itself.
        if base and key.method != method and (values := pair(run, quantity)):
            pairs[key] = [100 * value / of for value, of in zip(values, base)]
    return label, pairs


def rows_of(pairs, kind):
    """Returns values by row of panels, then by group of bars; a row has two groups at least."""
    rows = {}
    for key, values in pairs.items():
        if key.map or kind == "viewport":
            place = size(key.viewport) if kind == "map" else f"map {size(key.map)}"
            title = ", ".join([key.scene, key.view, place][: 3 if key.map else 2])
            groups = rows.setdefault((key.scene, key.view, title), {})
            groups.setdefault(getattr(key, kind), {})[key.method] = values
    return {row: dict(sorted(groups.items())) for row, groups in rows.items() if len(groups) > 1}


def charts(runs, left_out):
    """Yields name, text, rows and labels of axes of each chart; lists what is left out."""
    views = {key[:2] for key in runs}
    for quantity in dict.fromkeys(quantity for theirs, _ in runs.values() for quantity in theirs):
        if quantity != "fps" and not quantity.startswith("ms.") and "_percent" not in quantity:
            continue  # Counts are drawn as shares.
        label, pairs = bars(runs, quantity)
        printed = [runs[key][0][quantity] for key in pairs]
        remarks = dict.fromkeys(f"{row['source']}: {row['note']}" for row in printed if row["note"])
        rows = {kind: rows_of(pairs, kind) for kind in GROUPS}
        if not any(rows.values()):
            why = NO_TWO.format(" or ".join(GROUPS.values()))
            why = why if label else "no method without a map has times there"
            left_out.append(f"not drawn: {quantity}: {why}")
        for kind in filter(rows.get, GROUPS):
            name = re.sub("[._+]", "-", quantity.removesuffix("_percent")) + f"-by-{kind}"
            if more := ", ".join(sorted(map(" ".join, views - {row[:2] for row in rows[kind]}))):
                left_out.append(f"not in {name}: {more}: {NO_TWO.format(GROUPS[kind])}")
            yield name, [f"{head(quantity)} by {kind}", *remarks], rows[kind], (kind, label)
    sums = {key: pair(run, SUM) for key, run in runs.items() if not key.map}
    if rows := rows_of({key: both for key, both in sums.items() if both and all(both)}, "viewport"):
        title = "time by viewport of methods without a map"
        yield "time-by-viewport", [title, "Sums of steps."], rows, ("pixels", "times the smallest")


def fill(panel, groups, side, axes, methods):
    """Draws a bar for each method of each group, or lines over the pixels of viewports."""
    shown = [method for method in methods if any(method in group for group in groups.values())]
    wide = 0.84 / len(shown)
    for index, method in enumerate(shown):
        values = {place: group[method][side] for place, group in groups.items() if method in group}
        look = methods.index(method) % len(COLOURS)
        if axes[0] == "pixels":
            x, first = [width * height for width, height in values], next(iter(values.values()))
            y = [value / first for value in values.values()]
            panel.loglog(x, y, "o-", color=COLOURS[look], label=method)
            panel.yaxis.set_major_formatter("{x:g}")
            panel.yaxis.set_minor_formatter("{x:g}")
        else:
            x = [list(groups).index(place) + (index + 0.5) * wide - 0.42 for place in values]
            looks = {"color": COLOURS[look], "hatch": HATCHES[look], "edgecolor": "white"}
            panel.bar(x, values.values(), 0.92 * wide, label=method, **looks)
            panel.set_xticks(range(len(groups)), map(size, groups))
    panel.set(xlabel=axes[0], ylabel="" if side else axes[1])
    panel.grid(axis="y", alpha=0.3)


def draw(file, title, notes, rows, axes, label, methods):
    """Draws two panels for each row, theirs and ours, into a file that is replaced whole."""
    notes = [line for note in notes for line in textwrap.wrap(note, 150)]
    above, tall = 1.1 + 0.16 * len(notes), 2.8
    height = above + tall * len(rows)
    figure, panels = pyplot.subplots(
        len(rows), 2, figsize=(10, height), sharex="row", sharey="row", squeeze=False
    )
    edges = {"left": 0.08, "right": 0.99, "top": 1 - above / height, "bottom": 0.5 / height}
    figure.subplots_adjust(hspace=0.4, wspace=0.1, **edges)
    figure.text(0.01, 1 - 0.1 / height, title, size=14, va="top")
    figure.text(0.01, 1 - 0.4 / height, "\n".join(notes), va="top")
    signs = {}
    for sides, ((*_, place), groups) in zip(panels, rows.items()):
        for side, panel in enumerate(sides):
            fill(panel, groups, side, axes, methods)
            panel.set_title(f"{(label, 'ours')[side]}: {place}", loc="left", size=9)
            signs |= {text: sign for sign, text in zip(*panel.get_legend_handles_labels())}
    below = (0, 1 - (0.4 + 0.16 * len(notes)) / height)
    figure.legend(
        signs.values(), signs, ncol=8, loc="upper left", bbox_to_anchor=below, frameon=False
    )
    figure.savefig(f"{file}.part", format="svg", metadata={"Date": None})
    pyplot.close(figure)
    os.replace(f"{file}.part", file)


def main():
    args = arguments()
    label, _, file = args.beside.rpartition(":")
    label, lines = label or Path(file).stem, read_published(file)
    runs, left_out, conditions = {}, [], set()
    for folder in args.folders:
        # A comparison of several scenes has a folder for each.
        own = (folder / "results.csv").is_file()
        files = [folder / "results.csv"] if own else sorted(folder.glob("*/results.csv"))
        if not files:
            sys.exit(f"there is no results.csv in {folder}")
        for key, row in (run for file in files for run in read_measured(file.parent)):
            if row["unavailable"]:
                left_out.append(f"not drawn: {key.method}: {row['unavailable']}")
                continue
            theirs = {other["quantity"]: other for keys, other in lines if key in keys}
            runs[key] = theirs, our_figures(row)
            conditions.add(f"{row['adapter']}, {row['driver']}, medians of {row['frames']} frame(s)")
    left_out += without_counterpart(runs, lines, label)
    methods = list(dict.fromkeys(key.method for key in runs))
    pyplot.rcParams |= {"svg.fonttype": "none", "svg.hashsalt": "skiagraph", "font.size": 8}
    args.out.mkdir(parents=True, exist_ok=True)
    count = 0
    whose = f"Left: {label}, as published. Right: ours, {'; '.join(sorted(conditions))}."
    for name, (title, *notes), rows, axes in charts(runs, left_out):
        draw(args.out / f"{name}.svg", title, [whose, *notes], rows, axes, label, methods)
        count += 1
    print(*left_out, f"{count} charts in {args.out}", sep="\n", file=sys.stderr)
    if count == 0:
        sys.exit(f"there is nothing to draw: {label} has no figures of two maps or viewports here")


if __name__ == "__main__":
    main()
