#!/usr/bin/env python3
"""Checks what `skiagraph merge` joined of several adapters' folders:

    scripts/adapters.py DIR                    DIR/adapters.json
    scripts/adapters.py DIR --equal 'Mesa 25'  whose errors must be those of the first, to the pixel

On every adapter, methods that promise to be exact have no wrong pixel outside the band, methods that
must answer alike do so to the bit, and no row crashed, failed, hung or lost the device. Shares of wrong pixels are within 0.05 points of the first adapter's: of an
exact method in each cell, or within the share that rounding decides there, of any other over the
cells of a row. Exit 0 if all of it holds, 1 if not.
"""

import argparse
import json
import sys
from pathlib import Path

POINTS = 0.05


def key(cell):
    return (cell["scene"], cell["triangles"], cell["view"], cell["method"], *cell["viewport"], cell["map_size"])


def cells(record):
    """Cells by row and key."""
    found = ((row["row"], cell) for row in record["rows"] for cell in row["figures"].get("cells", []))
    return {(row, *key(cell)): cell for row, cell in found if "unavailable" not in cell}


def points(cell, count):
    return 100 * cell[count] / max(cell["facing"], 1)


def own_faults(record):
    for row in record["rows"]:
        figures = row["figures"]
        if row["outcome"] not in ("done", "lacking"):
            yield f"{row['row']}: {row['outcome']}: {' / '.join(row['said'][-3:])}"
        for cell in figures.get("cells", []):
            if cell["is_exact"] and cell["wrong_outside"]:
                yield f"{key(cell)}: {cell['wrong_outside']} wrong pixels outside the band"
        for equal in figures.get("equal", []):
            if equal["differing"]:
                yield f"{equal['methods']} on {equal['view']}: {equal['differing']} pixels differ"


def faults_beside(first, record, must_be_equal):
    """The faults, and the greatest difference of a cell with its place."""
    ours, theirs = cells(first), cells(record)
    both = sorted(ours.keys() & theirs.keys(), key=str)
    found = [] if both else ["no cell in common with the first adapter"]
    sums, worst = {}, (0.0, None)
    for place in both:
        one, other = ours[place], theirs[place]
        if must_be_equal and (one["wrong"], one["facing"]) != (other["wrong"], other["facing"]):
            found.append(f"{place}: {other['wrong']} of {other['facing']} wrong, not {one['wrong']} of {one['facing']}")
        apart = abs(points(one, "wrong") - points(other, "wrong"))
        if one["is_exact"] and apart > max(POINTS, points(one, "band"), points(other, "band")):
            found.append(f"{place}: {apart:.3f} points apart")
        worst = max(worst, (apart, place), key=lambda found: found[0])
        # A rasteriser that snaps corners to a coarser grid shifts edges in a map, in one view to the
        # better, in the next to the worse.
        row = sums.setdefault((place[0], one["method"]), [{"wrong": 0, "facing": 0} for _ in range(2)])
        for total, cell in zip(row, (one, other)):
            for count in total:
                total[count] += cell[count]
    for (row, method), (one, other) in sums.items():
        apart = abs(points(one, "wrong") - points(other, "wrong"))
        if apart > POINTS:
            found.append(f"{row}, {method}: {apart:.3f} points apart over all cells")
    return found, worst


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", type=Path)
    parser.add_argument("--equal", default="", metavar="DRIVER")
    args = parser.parse_args()
    records = json.loads((args.folder / "adapters.json").read_text())
    failed, met = 0, not args.equal
    for record in records:
        adapter = record["abilities"]["adapter"]
        is_equal = bool(args.equal) and args.equal in adapter["driver"]
        met |= is_equal
        found = list(own_faults(record))
        worst = (0.0, None)
        if record is not records[0]:
            beside, worst = faults_beside(records[0], record, is_equal)
            found += beside
        failed += len(found)
        rows = [row["row"] for row in record["rows"]]
        print(f"{adapter['name']} · {adapter['backend']} · {adapter['driver']}: {len(rows)} rows, "
              f"{len(cells(record))} cells, {len(found)} faults")
        if worst[1]:
            print(f"  most points apart in a cell: {worst[0]:.3f}, {worst[1]}")
        print("".join(f"  FAILED {fault}\n" for fault in found), end="")
    if not met or len(records) < 2:
        failed += 1
        print(f"FAILED {len(records)} adapters, of `{args.equal}` none" if not met else "FAILED only one adapter")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
