#!/usr/bin/env python3
"""Checks that presets can be read: `scripts/presets.py`, exit 0 fine, 1 not.

The methods of `tests/foreign/engine`, too, but for the numbers of lines.
No line over 120 columns; a line begins one pass, param or material at most; every param has a
description; no expression of more than 30 characters stands twice in a document; no two `Change`
edit entries of one name; no shader is another one for masked scenes. `nsm` is read in five
documents and 150 lines, `light_buffer.ron`, which extends none, has 150 lines at most, all documents together 1,200.
"""

import collections
import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PIPELINES = ROOT / "pipelines"
ENGINE = ROOT / "tests" / "foreign" / "engine"
COLUMNS, LONG = 120, 30
LINES, NSM_LINES, NSM_DOCUMENTS, LIGHT_BUFFER_LINES = 1200, 150, 5, 150
ENTRY = re.compile(r"\b[A-Z]\w*\((?:name|graph|pass|after|before|instead):")
PARAM = re.compile(r"\b(?:F32|I32|U32|Bool|Vec[234]|Choice)\(name: \"(\w+)\"(.*?)(?=\n        [A-Z/]|\n    \])", re.DOTALL)
TEXT = re.compile(r'(\w+|"\w+"):\s*"((?:\\.|[^"\\])*)"', re.DOTALL)
# Prose, and paths of entries and documents, are no expressions.
NO_EXPRESSION = {"description", "because", "pass", "after", "before", "instead", "graph"}


def documents(name, seen):
    """The documents that one is made of, itself included."""
    file = PIPELINES / name
    if file in seen:
        return seen
    seen.append(file)
    for other in re.findall(r'(?:graph|extends): "([^"]+)"', file.read_text()):
        beside = file.parent / other
        documents(str((beside if beside.exists() else PIPELINES / other).relative_to(PIPELINES)), seen)
    return seen


def faults_of(texts):
    """What cannot be read in documents, file by file."""
    for file, text in texts.items():
        name = file.relative_to(ROOT)
        for number, line in enumerate(text.splitlines(), 1):
            if len(line) > COLUMNS:
                yield f"{name}:{number}: {len(line)} columns"
            if len(ENTRY.findall(line)) > 1:
                yield f"{name}:{number}: several entries begin here"
        for param, rest in PARAM.findall(text):
            if "description:" not in rest:
                yield f"{name}: the param `{param}` has no description"
        written = [value for key, value in TEXT.findall(text) if key not in NO_EXPRESSION]
        for value, count in collections.Counter(written).items():
            if len(value) > LONG and count > 1:
                yield f"{name}: `{value}` stands {count} times: name it in `values`"
        changed = [path.rsplit(".", 1)[-1] for path in re.findall(r'Change\(pass: "([^"]+)"', text)]
        for entry, count in collections.Counter(changed).items():
            if count > 1:
                yield f"{name}: {count} entries called `{entry}` are changed"


def faults():
    texts = {file: file.read_text() for file in sorted(PIPELINES.rglob("*.ron"))}
    yield from faults_of(texts)
    yield from faults_of({file: file.read_text() for file in sorted(ENGINE.glob("*.ron"))})
    lines = {file: len(text.splitlines()) for file, text in texts.items()}
    nsm = documents("nsm.ron", [])
    for what, found, most in [
        ("lines of all documents", sum(lines.values()), LINES),
        ("documents of nsm", len(nsm), NSM_DOCUMENTS),
        ("lines of nsm's documents", sum(lines[file] for file in nsm), NSM_LINES),
        ("lines of light_buffer.ron", lines[PIPELINES / "light_buffer.ron"], LIGHT_BUFFER_LINES),
    ]:
        print(f"{what}: {found}, {most} at most")
        if found > most:
            yield f"{what}: {found}"
    for twin in (ROOT / "shaders").rglob("*_masked.wgsl"):
        if (twin.parent / twin.name.replace("_masked", "")).exists():
            yield f"{twin.relative_to(ROOT)} is a masked twin: use `imports`"


def main():
    found = list(faults())
    for fault in found:
        print(fault)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
