#!/usr/bin/env python3
"""Checks that methods are right wherever the reference is sure.

    scripts/outside_band.py DIR METHOD… [--uncertain SHARE] [--open-parts]

Exit 0 if each method has runs in DIR/results.json, all of them have 0 wrong pixels outside the
band, and some pixels face the light; 1 if not. With --uncertain, no run may have called more than
this share of the pixels that face the light uncertain, either: 0.0001 is 0.01 %. With --open-parts,
certain wrong pixels are no fault where all that blocks them are open parts of the mesh, as far as
front faces are culled.
"""

import argparse
import json
import math
import statistics
import sys
from pathlib import Path


def faults(run, most_uncertain, open_parts):
    if "unavailable" in run:
        return [run["unavailable"]]
    found = []
    outside = run["wrong"]["total"] - run["wrong"]["in_band"]
    if open_parts and run["params"].get("cull") == "front":
        outside -= run.get("certain_wrong_blockers", {"open_part": 0})["open_part"]
    if outside:
        found.append(f"{outside} wrong pixels outside the band")
    facing, uncertain = run["pixels"]["facing_light"], run["uncertain"]
    if most_uncertain is not None and uncertain > most_uncertain * facing:
        found.append(f"{uncertain} of {facing} pixels uncertain")
    return found


def main(folder, methods, most_uncertain, open_parts):
    runs = json.loads((Path(folder) / "results.json").read_text())["runs"]
    failed = 0
    for method in methods:
        own = [run for run in runs if run["preset"] == method]
        for run in own:
            width, height = run["viewport"]
            at_map = f", map {run['map_size']}" if run["map_size"] else ""
            where = f"{folder}: {method}, {run['view']}, {width}x{height}{at_map}"
            found = faults(run, most_uncertain, open_parts)
            failed += len(found)
            print(f"FAILED {where}: {'; '.join(found)}" if found else f"ok     {where}")
        measured = [run for run in own if "unavailable" not in run]
        if not any(run["pixels"]["facing_light"] for run in measured):
            failed += 1
            print(f"FAILED {folder}: {method} has no pixel that faces the light")
            continue
        facing = [run["pixels"]["facing_light"] for run in measured]
        shares = [run["pixels"]["facing_light"] / math.prod(run["viewport"]) for run in measured]
        uncertain = [run["uncertain"] for run in measured]
        print(
            f"{folder}: {method}, {len(measured)} runs; {sum(facing):,} pixels face the light, "
            f"{statistics.median(shares):.0%} of a picture in the median; uncertain are "
            f"{sum(uncertain):,}, at most {max(uncertain):,} of a run"
        )
    return 1 if failed else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("methods", nargs="+", metavar="METHOD")
    parser.add_argument("--uncertain", type=float, metavar="SHARE")
    parser.add_argument("--open-parts", action="store_true")
    given = parser.parse_args()
    sys.exit(main(given.folder, given.methods, given.uncertain, given.open_parts))
