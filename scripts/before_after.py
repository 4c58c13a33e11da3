#!/usr/bin/env python3
"""Compares two programs: `scripts/before_after.py OLD NEW`, exit 0 alike, 1 not.

Runs the same commands with both, each in a folder of its own, and compares exit codes, both
streams and all files: pictures byte by byte, records value by value but for times, dates and
fingerprints. Then both read the results of the old one, so that tables, verdicts, pages and charts
are compared with their times. Words that were renamed on purpose stand in `scripts/renamed.txt`,
one `old => new` a line, and are put into the old program's answers first; `=> new` alone is left
out of the new one's.

    scripts/before_after.py OLD NEW --out DIR    keeps both folders there
"""

import argparse
import csv
import difflib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
RENAMED = ROOT / "scripts" / "renamed.txt"
SMALL = "--size 64x48 --frames 2 --warmup 1 --regime-frames 1"
# The commands of the first part measure by themselves.
MEASURING = f"""
presets --format markdown
scenes
graph nsm --format json
graph crsm --format dot --set cull=none
graph light_buffer --out light_buffer.svg
check broken/all_at_once.ron
check broken/bind_twice.ron broken/choice_clash.ron
new mine
new variant --from nsm
check mine.ron variant.ron --format json
doctor
compare nsn --out none
compare nsm --set cul=none --out none
compare nsm --set cull=sideways --out none
compare nsm --scene nowhere --out none
compare nsm --scene broken.obj --out none
compare nsm --view nowhere --out none
compare nsm --frames many --out none
compare nsm --map-size 999999 --out none
compare mine.ron nsm rt light_buffer hybrid_pcf --out hard --map-size 64,128 {SMALL}
compare nsm rt light_buffer --scene lamps --view all --out lamps --map-size 64 --images none {SMALL}
compare rt_area pcf hybrid_pcf_area --scene park_soft --out soft --reference-samples 64 {SMALL}
compare nsm crsm --path walk --out path --map-size 64 --size 64x48 --warmup 1
compare nsm --out published --beside D:published.csv --map-size 64 {SMALL}
stress nsm crsm light_buffer --case box_on_floor --size 48x48 --map-size 48 --out stress --save cells
run crsm --size 64x48 --map-size 64 --save status=status.png --save inner=map.png
run nsm --size 64x48 --save nothing=nothing.png
run nsm --path walk --frames 3 --size 48x48 --save visibility=frames.png
profile nsm --size 64x48 --frames 3 --json profile.json --csv profile.csv
"""
# Those of the second read the old program's results.
READING = f"""
compare mine.ron nsm rt light_buffer hybrid_pcf --out hard --map-size 64,128 --resume --details {SMALL}
compare mine.ron nsm rt light_buffer hybrid_pcf --out hard --map-size 64,128 --resume --format markdown --passes {SMALL}
compare nsm rt light_buffer --scene lamps --view all --out lamps --map-size 64 --images none --resume {SMALL}
compare rt_area pcf hybrid_pcf_area --scene park_soft --out soft --reference-samples 64 --resume {SMALL}
compare nsm crsm --path walk --out path --map-size 64 --size 64x48 --warmup 1 --resume --format markdown
compare nsm --out published --beside D:published.csv --map-size 64 --resume --format markdown {SMALL}
compare nsm --scene lamps --out hard --map-size 64 --resume {SMALL}
report hard lamps soft path stress --out page.html
report nowhere --out page.html
chart hard --out front.svg
chart hard lamps
chart lamps --out front.png
chart hard --kind growth --out growth.svg
"""
PUBLISHED = """scene,preset,view,viewport,map_size,quantity,value,source,note
park,nsm,bench_side,64x48,64,wrong_percent,4.5,table 1,
"""
TIMED = re.compile(r"(^|_)(ms|date|fingerprint|timestamp|per_second)$|^(min|median|p95|max|samples|share)$|slowest")
PLACE = re.compile(r"(?<=\.ron):\d+")
TIME = re.compile(r"\d[\d,.]*(?= ?(?:ms|s|fps|MB/s)\b)")
DATE = re.compile(r"\b\d{4}-\d\d-\d\d(?:T[\d:]+Z)?\b")
DECIMAL = re.compile(r"(?: *\d[\d,]*\.\d+)")


def folder_for_commands(folder):
    """A user's folder: broken documents, a mesh that is none, published figures."""
    shutil.copytree(ROOT / "crates" / "graph" / "tests" / "broken", folder / "broken")
    (folder / "scenes").mkdir()
    shutil.copy(ROOT / "scenes" / "lamps.ron", folder / "scenes")
    (folder / "broken.obj").write_text("v 0 0 zero\nf 1 2 3\n")
    (folder / "published.csv").write_text(PUBLISHED)


def put(text, renames):
    for old, new in renames:
        text = text.replace(old, new) if new else re.sub(r"\s*" + re.escape(old), "", text)
    return text


def run(program, words, folder):
    done = subprocess.run([program, *words.split()], cwd=folder, capture_output=True, timeout=900)
    return done.returncode, done.stdout.decode(), done.stderr.decode()


def without_times(value, key=""):
    """A record without what differs from run to run."""
    if TIMED.search(key):
        return "measured" if value not in (None, []) else value
    if isinstance(value, dict):
        return {name: without_times(part, name) for name, part in value.items()}
    if isinstance(value, list):
        return [without_times(part) for part in value]
    return value


def table_without_times(text):
    rows = list(csv.reader(io.StringIO(text)))
    masked = [bool(TIMED.search(head)) for head in rows[0]]
    return [[hide and bool(cell) or cell for hide, cell in zip(masked, row)] for row in rows[1:]] + rows[:1]


def plain(text, is_measured):
    """An answer to compare: times are left out where each program has measured its own."""
    text = PLACE.sub("", text)
    if not is_measured:
        return DATE.sub("DATE", text)
    text = DATE.sub("DATE", TIME.sub("TIME", text))
    return re.sub(r" +|─+|═+", " ", DECIMAL.sub(" N", text))


def read(file, is_measured, renames):
    """The content of a file, in a form that can be compared."""
    data = file.read_bytes()
    if file.suffix not in (".json", ".csv", ".svg", ".html"):
        # Comments of documents that it wrote are prose.
        return re.sub(rb"//[^\n]*", b"", data) if file.suffix == ".ron" else data
    text = data.decode()
    if file.suffix == ".html":
        # Its scripts and styles are the program's own, its charts and tables are those of the terminal.
        text = "{}" if is_measured else re.search(r'id="data">(.*?)</script>', text, re.DOTALL).group(1)
        of_page = json.loads(text)
        of_page.pop("stress", None)
        for table in of_page.get("tables", []):
            for key in ("rows", "wall", "what", "of"):
                table.pop(key, None)
        text = json.dumps(of_page)
        # Its pictures are files beside it.
        text = re.sub(r'"[\w+/=]{200,}"', "PICTURE", text).replace(",", ",\n")
    elif file.suffix == ".json":
        text = json.dumps(without_times(json.loads(text)), indent=1)
    elif is_measured and file.suffix == ".csv":
        text = DECIMAL.sub("N", "\n".join(map(str, table_without_times(text))))
    return PLACE.sub("", put(text, renames))


def differences(label, old, new):
    if old == new:
        return []
    if isinstance(old, bytes) or isinstance(new, bytes):
        return [f"{label}: {len(old)} and {len(new)} bytes differ"]
    lines = difflib.unified_diff(old.splitlines(), new.splitlines(), "old", "new", lineterm="", n=1)
    return [f"{label}:", *(f"    {line}" for line in list(lines)[:40])]


def compared(commands, programs, folders, is_measured, renames):
    """Runs the commands with both programs; returns what differs."""
    found = []
    for words in commands.strip().splitlines():
        (old, *one), (new, *other) = [run(program, words, folder) for program, folder in zip(programs, folders)]
        of = differences(f"exit code of `{words}`", str(old), str(new))
        for name, one, other in zip(("stdout", "stderr"), one, other):
            # A table's rows are in the order of their times.
            if not (is_measured and name == "stdout" and words.startswith(("compare", "profile"))):
                texts = [plain(put(text, pairs), is_measured) for text, pairs in zip((one, other), renames)]
                of += differences(f"{name} of `{words}`", *texts)
        print(f"{'differs' if of else 'alike'}, exit {old}: skiagraph {words}", flush=True)
        found += of
    # Cells stand in results.json, too.
    files = [
        {
            str(file.relative_to(folder))
            for file in folder.rglob("*")
            if file.is_file() and file.parent.name != "cells" and not file.name.endswith(".lock")
        }
        for folder in folders
    ]
    found += [f"only one program wrote {name}" for name in sorted(files[0] ^ files[1])]
    for name in sorted(files[0] & files[1]):
        texts = [read(folder / name, is_measured, pairs) for folder, pairs in zip(folders, renames)]
        found += differences(name, *texts)
    print(f"{len(files[0] & files[1])} files compared", flush=True)
    return found


def hand_over(name, folders):
    """Gives the new program the old one's results as if it had measured them: of the same shaders
    and params."""
    of = [json.loads((folder / name / "results.json").read_text()) for folder in folders]
    shutil.rmtree(folders[1] / name)
    shutil.copytree(folders[0] / name, folders[1] / name)
    shutil.rmtree(folders[1] / name / "cells", ignore_errors=True)
    for old, new in zip(of[0]["runs"], of[1]["runs"]):
        old["fingerprint"], old["params"] = new["fingerprint"], new["params"]
    (folders[1] / name / "results.json").write_text(json.dumps(of[0], indent=2, ensure_ascii=False))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--out", type=Path)
    arguments = parser.parse_args()
    programs = [arguments.old.resolve(), arguments.new.resolve()]
    pairs = [line.split("=> ", 1) for line in RENAMED.read_text().splitlines() if "=> " in line]
    renames = [(old[:-1], new) for old, new in pairs if old], [(new, "") for old, new in pairs if not old]

    with tempfile.TemporaryDirectory() as place:
        out = arguments.out or Path(place)
        folders = [out / "old" / "work", out / "new" / "work"]
        for folder in folders:
            folder.mkdir(parents=True)
            folder_for_commands(folder)
        os.environ.setdefault("XDG_RUNTIME_DIR", tempfile.gettempdir())
        found = compared(MEASURING, programs, folders, True, renames)
        for name in ("hard", "lamps", "soft", "path", "published"):
            hand_over(name, folders)
        for name in ("profile.json", "profile.csv", "stress/stress.json"):
            shutil.copy(folders[0] / name, folders[1] / name)
        found += compared(READING, programs, folders, False, renames)
    print("\n".join(found))
    count = sum(len(commands.split("\n")) - 2 for commands in (MEASURING, READING))
    print(f"before and after: {'DIFFERENT' if found else 'alike'} in {count} commands")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
