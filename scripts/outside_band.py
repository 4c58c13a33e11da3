#!/usr/bin/env python3
"""Checks that methods are right wherever the reference is sure.

    scripts/outside_band.py DIR METHOD…     exit 0 if each has runs in DIR/results.json, and all of
                                            them have 0 wrong pixels outside the band; 1 if not
"""

import json
import sys
from pathlib import Path


def main(folder, methods):
    runs = json.loads((Path(folder) / "results.json").read_text())["runs"]
    failed = 0
    for method in methods:
        own = [run for run in runs if run["preset"] == method]
        if not own:
            failed += 1
            print(f"FAILED {folder}: no run of {method}")
        for run in own:
            width, height = run["viewport"]
            where = f"{folder}: {method}, {run['view']}, {width}x{height}"
            if "unavailable" in run:
                failed += 1
                print(f"FAILED {where}: {run['unavailable']}")
                continue
            outside = run["wrong"]["total"] - run["wrong"]["in_band"]
            failed += outside > 0
            print(f"{'FAILED' if outside else 'ok    '} {where}: {outside} wrong pixels outside the band")
    return 1 if failed else 0


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    sys.exit(main(sys.argv[1], sys.argv[2:]))
