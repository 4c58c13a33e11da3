#!/usr/bin/env python3
"""Writes the tables of docs/results, or checks them with --check: exit 0 alike, 1 not.

Each document is what the command in its head prints, and the commit of the program that ran it.
--check runs the commands with one frame and compares all figures but times.

    scripts/tables.py                                              writes all of them
    scripts/tables.py --check sponza-d --size 512x512 --map-size 1024    checks a part of one
"""

import argparse
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCUMENTS = ["sponza", "sponza-d", "sizes", "bench", "bench-d"]
TIMED = re.compile(r" ms$|^fps$")
ONE_FRAME = {"--frames": "1", "--warmup": "0", "--regime-frames": "0"}


def figures(text):
    """All figures but times by their place; notes below tables, which span maps, are left out."""
    found, view, viewport, heads = {}, "", "", []
    for line in text.splitlines():
        row = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("### "):
            view = line[4:]
        elif line.startswith("**"):
            viewport, counts = line.split(": ", 1)
            found[view, viewport] = counts
        elif line.startswith("| method"):
            heads = row
        elif line.startswith("| "):
            counted = [(head, cell) for head, cell in zip(heads, row) if not TIMED.search(head)]
            found.update({(view, viewport, *row[:2], head): cell for head, cell in counted})
    return found


def measure(program, text, options):
    """Runs the command in a document's head, with other values of options; returns what it prints."""
    words = re.search(r"^    skiagraph (.*)$", text, re.MULTILINE).group(1).split()
    for option, value in options.items():
        if option in words:
            words[words.index(option) + 1] = value
        else:
            words += [option, value]
    out = ROOT / words[words.index("--out") + 1]
    shutil.rmtree(out, ignore_errors=True)
    done = subprocess.run([program, *words], cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    commit = json.loads((out / "results.json").read_text())["runs"][0]["commit"]
    # The overview at its end has times, and a verdict that hangs on them.
    text = done.stdout.split("\n## In short")[0]
    return text.replace("\n- date: ", f"\n- commit: {commit}\n- date: ", 1)


def check(name, old, new, is_part):
    """Prints where a document and what is printed now differ; returns how many places do."""
    old, new = figures(old), figures(new)
    places = new if is_part else old | new
    differing = [place for place in places if old.get(place) != new.get(place)]
    for place in differing:
        print(f"FAILED {name}: {', '.join(place)}: {new.get(place, 'nothing')}, in the document {old.get(place, 'nothing')}")
    print(f"{name}: {len(new)} of {len(old)} figures measured, {len(differing)} differ", flush=True)
    return len(differing) if new else 1


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("documents", nargs="*", default=DOCUMENTS, metavar="DOCUMENT")
    parser.add_argument("--program", default=str(ROOT / "target/release/skiagraph"))
    parser.add_argument("--check", action="store_true")
    parser.add_argument("--size")
    parser.add_argument("--map-size")
    given = parser.parse_args()
    part = {"--size": given.size, "--map-size": given.map_size}
    part = {option: value for option, value in part.items() if value}
    if part and not given.check:
        parser.error("a part of a document can only be checked")
    failed = 0
    for name in given.documents:
        file = ROOT / "docs/results" / f"{name}.md"
        old = file.read_text()
        if given.check:
            new = measure(given.program, old, part | ONE_FRAME | {"--out": f"out/check-{name}"})
            failed += check(name, old, new, bool(part))
        else:
            file.write_text(measure(given.program, old, {}))
            print(f"{file.relative_to(ROOT)} is written", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
