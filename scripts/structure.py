#!/usr/bin/env python3
"""Checks that types and folders have walls, so that a reader knows who may touch what:

    impl    methods of a type stand in the file that declares it
    circle  folders directly under a crate's `src` do not import each other in a circle
    whole   no function outside its file takes one of `WHOLE` by `&mut`

Tests are left out. `scripts/structure.txt`, where it exists, lists what offends still; a new offence
fails, and so does a line of the list that offends no more.

    scripts/structure.py            exit 0 fine, 1 not
    scripts/structure.py --list     prints the list as it should be
    scripts/structure.py --edges    prints which files make each folder import another
"""

import re
import sys

from house import ROOT, circles, code, imports, modules, paths

LIST = ROOT / "scripts" / "structure.txt"
WHOLE = {
    "crates/graph/src/instantiate/symbols.rs": "SymbolTable",
    "crates/graph/src/instantiate/build.rs": "Builder",
}
TYPE = re.compile(r"\b(?:struct|enum|union|trait)\s+(\w+)")
IMPL = re.compile(r"^\s*impl\b([^{;]*)\{", re.MULTILINE)
SIGNATURE = re.compile(r"\bfn\s+(\w+)([^{;]*)")


def name_of(header):
    """The type of an inherent `impl`, without its generics; none for that of a trait."""
    depth, plain = 0, ""
    for sign in header.replace("->", "  "):
        depth += (sign == "<") - (sign == ">")
        plain += sign if depth == 0 and sign not in "<>" else " "
    plain = re.split(r"\bwhere\b", plain)[0].split()
    return None if "for" in plain or not plain else plain[0].split("::")[-1]


def declared(name, file, text, types):
    """The file that declares a type that another file names."""
    files = types.get(name, [])
    if file in files or len(files) < 2:
        return file if file in files else next(iter(files), None)
    # Two types of one name: the import says which.
    for path in paths(text):
        parts = path.split("::")
        if parts[-1] == name and len(parts) > 1:
            for other in files:
                if other.stem == parts[-2] or other.parent.name == parts[-2]:
                    return other
    return None


def in_crate(folder):
    """The offences of a crate, as the lines of the list."""
    texts = {file: code(file.read_text()) for file in modules(folder).values()}
    types = {}
    for file, text in texts.items():
        for name in TYPE.findall(text):
            types.setdefault(name, []).append(file)
    for file, text in texts.items():
        place = file.relative_to(ROOT)
        for header in IMPL.findall(text):
            name = name_of(header)
            home = declared(name, file, text, types) if name else file
            if home not in (file, None):
                yield f"impl {place} {name}, of {home.relative_to(folder)}"
        for function, signature in SIGNATURE.findall(text):
            for name in re.findall(r"&\s*(?:'\w+\s+)?mut\s+(?:\w+::)*(\w+)", signature):
                home = declared(name, file, text, types)
                if home not in (file, None) and WHOLE.get(str(home.relative_to(ROOT))) == name:
                    yield f"whole {place} {function} takes {name}"
    for circle in circles(folders(folder)):
        yield f"circle {folder.relative_to(ROOT)} {' '.join(circle)}"


def folders(folder):
    """Which folders of a crate import which, and by which files."""
    edges = {}
    for file, targets in imports(folder).items():
        for target in targets:
            pair = [path.relative_to(folder).parts for path in (file, target)]
            if min(map(len, pair)) > 1 and pair[0][0] != pair[1][0]:
                by = edges.setdefault(pair[0][0], {}).setdefault(pair[1][0], [])
                by.append(f"{file.relative_to(folder)} -> {target.relative_to(folder)}")
    return edges


def main():
    sys.setrecursionlimit(10_000)
    crates = sorted(ROOT.glob("crates/*/src"))
    if "--edges" in sys.argv:
        for folder in crates:
            for one, targets in sorted(folders(folder).items()):
                for other, files in sorted(targets.items()):
                    print(f"{folder.relative_to(ROOT)}: {one} -> {other}")
                    print(*(f"    {edge}" for edge in sorted(files)), sep="\n")
        return 0
    found = {line for folder in crates for line in in_crate(folder)}
    if "--list" in sys.argv:
        print(*sorted(found), sep="\n")
        return 0
    listed = set(LIST.read_text().splitlines()) if LIST.exists() else set()
    for line in sorted(found - listed):
        print(f"new: {line}")
    for line in sorted(listed - found):
        print(f"offends no more, take it out of {LIST.name}: {line}")
    print(f"structure: {len(found & listed)} known offences, {len(found ^ listed)} faults")
    return 1 if found != listed else 0


if __name__ == "__main__":
    sys.exit(main())
