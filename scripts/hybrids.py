#!/usr/bin/env python3
"""Checks that hybrids are certain only where they are right, on closed casters with conservative depth.

    scripts/hybrids.py DIR --cells N

Exit 0 if DIR/results.json has N cells of a view and a map, in each of which no certain pixel of an
exact hybrid is wrong, each uncertain pixel was traced, and each method is as certain as the one that
it refines; 1 if not.
"""

import argparse
import json
import sys
from pathlib import Path

EXACT = ("crsm", "crsm_hw", "crsm_depth", "crsma_full")


def require(holds, fault, failed):
    if not holds:
        print("FAILED", fault)
        failed.append(fault)


def check_run(run, where, failed):
    require((run["rays"] or 0) == run["uncertain"], f"{where}: an uncertain pixel is not traced", failed)
    wrong, facing = run["wrong"], run["pixels"]["facing_light"]
    traced = wrong["total"] - wrong["in_band"] - wrong["certain"]
    require(traced == 0, f"{where}: {traced} wrong pixels among those traced", failed)
    if run["preset"] in EXACT:
        require(wrong["certain"] == 0, f"{where}: {wrong['certain']} wrong certain pixels", failed)
        outside = wrong["total"] - wrong["in_band"]
        require(outside == 0, f"{where}: {outside} wrong determinate pixels", failed)
        share = run["uncertain"] / facing
        require(share <= 0.75, f"{where}: {share:.2%} uncertain, more than 75 %", failed)
        band = run["band"] / facing
        require(band <= 0.001, f"{where}: {band:.3%} indeterminate, more than 0.1 %", failed)


def check_cell(uncertain, where, failed):
    ordered = uncertain["crsma_full"] <= uncertain["crsma"] <= uncertain["crsm"]
    require(ordered, f"{where}: crsma_full <= crsma <= crsm does not hold", failed)
    alike = uncertain["crsm_depth"] == uncertain["crsm"]
    require(alike, f"{where}: crsm_depth does not classify as crsm does", failed)


def main(folder, expected):
    runs = json.loads((Path(folder) / "results.json").read_text())["runs"]
    failed, cells = [], {}
    for run in runs:
        cell = (run["view"], run["map_size"])
        where = f"{run['preset']}, {run['view']}, map {run['map_size']}"
        # An adapter that has it holds it to the same as crsm.
        if run["preset"] == "crsm_hw" and "unavailable" in run:
            named = "CONSERVATIVE_RASTERIZATION" in run["unavailable"]
            require(named, f"{where}: the reason does not name the feature", failed)
            continue
        cells.setdefault(cell, {})[run["preset"]] = run["uncertain"]
        check_run(run, where, failed)
    require(len(cells) == expected, f"{len(cells)} cells instead of {expected}", failed)
    for (view, size), uncertain in cells.items():
        check_cell(uncertain, f"{view}, map {size}", failed)
    print(f"{len(cells)} cells of a view and a map, {len(failed)} failures")
    return 1 if failed else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder")
    parser.add_argument("--cells", type=int, required=True)
    given = parser.parse_args()
    sys.exit(main(given.folder, given.cells))
