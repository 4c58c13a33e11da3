#!/usr/bin/env python3
"""Tables and checks of the folders that `adapter.sh` wrote, each of one adapter:

    scripts/adapters.py DIR DIR… --out ALL           ALL/adapters.md: the tables of docs/results/adapters.md
    scripts/adapters.py DIR DIR… --equal 'Mesa 25'   whose errors must be those of the first, to the pixel

On every adapter, methods that promise to be exact have no wrong pixel outside the band, methods that
must answer alike do so to the bit, and no row crashed, failed, hung or lost the device. Shares of
wrong pixels are within 0.05 points of the first adapter's: of an exact method in each cell, or within
the share that rounding decides there, of any other over the cells of a row. Exit 0 if all of it holds,
1 if not.
"""

import argparse
import json
import operator
import re
import sys
from array import array
from pathlib import Path

POINTS = 0.05
RMSE = 0.001
LACKING = "not on this adapter"
# Methods whose answers must be the same bits, by row: the first beside each of the others.
HARD = ["rt", "light_buffer"]
ALIKE = {"park": HARD, "lamps": HARD, "area": ["rt_area", "light_buffer_area"]}


def fields(path):
    """The lines `name: value` of a text file."""
    return dict(line.split(": ", 1) for line in path.read_text().splitlines())


def parsed(path, without):
    return json.loads(path.read_text()) if path.exists() else without


def read(folder):
    """An adapter: its abilities, and its rows in the order of the script's table."""
    if not (folder / "survey.txt").exists():
        sys.exit(f"{folder} has no survey.txt: name folders that adapter.sh wrote")
    rows = sorted((read_row(place.parent) for place in folder.glob("*/row.txt")), key=lambda row: int(row["number"]))
    survey = fields(folder / "survey.txt")
    is_small = survey["rows"] == "small"
    return json.loads((folder / "doctor.json").read_text()) | {"name": survey["adapter"], "is_small": is_small, "rows": rows}


def read_row(folder):
    results = parsed(folder / "results.json", {"runs": [], "scene": None})
    runs = [run | {"row": folder.name, "scene": results["scene"]} for run in results["runs"]]
    cases = parsed(folder / "stress.json", {"cases": []})["cases"]
    return fields(folder / "row.txt") | {
        "row": folder.name,
        "runs": runs,
        "alike": list(alike(folder, [run for run in runs if "unavailable" not in run])),
        "verdicts": [cell["verdict"] for case in cases for cell in case["cells"]],
        "folder": folder,
    }


def alike(folder, runs):
    """Pairs of methods that must answer alike on a view: both runs, and the number of pixels that differ."""
    first, *others = ALIKE.get(folder.name, [None])
    for one in runs:
        for other in runs:
            is_of_both = one["preset"] == first and other["preset"] in others
            if is_of_both and all(one.get(key) == other.get(key) for key in ("view", "light", "viewport")):
                words = [array("I", visibility(folder, run).read_bytes()) for run in (one, other)]
                yield one, other, sum(map(operator.ne, *words)) + abs(len(words[0]) - len(words[1]))


def visibility(folder, run):
    """The file that `compare --data npy` wrote for a run."""
    slug = [re.sub(r"[^\w.]", "-", run[key]).strip("-.").replace("--", "-") for key in ("preset", "view")]
    map_size = [f"map{run['map_size']}"] if run["map_size"] else []
    return folder / "-".join([*slug, size(run), *map_size, "visibility.npy"])


def ran(adapter, rows=""):
    """The runs of the rows whose name begins so, without those that the adapter cannot do."""
    return [run for run in asked(adapter, rows) if "unavailable" not in run]


def asked(adapter, rows):
    return [run for row in adapter["rows"] if row["row"].startswith(rows) for run in row["runs"]]


def is_exact(run):
    """True if answers are 0 and 1, and promised to be exact on this scene. Shares of light are compared by
    their bits instead."""
    promise = run.get("promise", {"of": None})
    is_promised = promise["of"] == "exact" and not (promise["closed_only"] and run["scene"]["parts"]["open"])
    return is_promised and run["answer"] == "hard" and "area" not in run


def wrong(run):
    return run["wrong"]["total"]


def outside_band(run):
    return max(run["wrong"]["total"] - run["wrong"]["in_band"], 0)


def band(run):
    return run["band"]


def rmse(run):
    return run["graded"]["rmse"] if run["answer"] == "graded" else 0


def facing(runs):
    return sum(run["pixels"]["facing_light"] for run in runs)


def points(runs, count=wrong):
    """Pixels that are counted, of those that face the light, in percent."""
    return 100 * sum(map(count, runs)) / max(facing(runs), 1)


def frame_ms(run):
    """Milliseconds of a frame: the GPU's clock, or the CPU's where the GPU's cannot be trusted."""
    return (run["frame"]["gpu_ms"] or run["frame"]["wall_ms"])["median"]


def longest_pass(run):
    """The 95th percentile of its time and its name; None without times of the GPU."""
    timed = [(each["gpu_ms"]["p95"], each["name"]) for each in run["passes"] if each["gpu_ms"]]
    return max(timed, default=None)


def size(run):
    return "x".join(map(str, run["viewport"]))


def triangles(run):
    return f"{run['scene']['triangles']:,}"


def place(run):
    return f"{run['preset']} on {run['scene']['name']}, {triangles(run)} triangles, {run['view']} {size(run)}"


def beside(first, adapter):
    """The runs of both adapters in pairs, whether their errors are equal, and by how many points they are
    apart; 0 in the last place where that is not more than rasterisers and rounding account for."""

    def key(run):
        return run["row"], place(run), run.get("light"), run["map_size"]

    theirs = {key(run): run for run in ran(adapter)}
    for one in ran(first):
        if other := theirs.get(key(one)):
            apart = abs(points([one]) - points([other]))
            is_beyond = apart > max(POINTS, points([one], band), points([other], band))
            is_equal = (wrong(one), facing([one])) == (wrong(other), facing([other]))
            yield one, other, is_equal, apart, apart if is_beyond else 0


# Tables: a row for each adapter, so that two drivers of one GPU stand under each other.


def markdown(adapters):
    lines = []

    def add(title, note, heads, words, rows_of):
        """A table whose first columns hold words; nothing if it has no rows."""
        rows = [[number, *row] for number, adapter in enumerate(adapters, 1) for row in rows_of(adapter)]
        cells = [[str(cell).replace("|", r"\|") for cell in row] for row in [["", "adapter", *heads], *rows]]
        head, *body = [f"| {' | '.join(row)} |" for row in cells]
        rule = "|" + "---|" * words + "---:|" * (len(cells[0]) - words)
        lines.extend([f"### {title}", "", note, "", head, rule, *body, ""] if rows else [])

    def pivot(title, note, heads, rows_of):
        """A table of rows with names and with cells by key, which have a column each."""
        keys = unique(key for adapter in adapters for _, cells in rows_of(adapter) for key in cells)

        def row(adapter):
            for names, cells in rows_of(adapter):
                yield [adapter["name"], *names, *(cells.get(key, "–") for key in keys)]

        add(title, note, [*heads, *keys], 2 + len(heads), row)

    add("Adapters", "A row is a question in a process of its own; *not done* names those that failed, crashed, hung "
        "or lost the device. The number in front is that of the other tables.",
        ["backend", "driver", "kind", "processor", "rows", "not done", "ray queries", "GPU times"], 10, abilities)
    add("Exactness", "Hard cases: cells that kept the method's guarantee, of those judged. Wrong: pixels of exact "
        "methods outside the band where rounding decides, of all that face the light. To the bit: pixels that differ, "
        "of those compared.",
        ["hard cases", "by ray queries", "wrong, exact methods", "hard, to the bit", "area, to the bit", "wrong, nsm"],
        2, exactness)
    add("Errors beside the first adapter", "The same cells on both. Beyond: their shares of wrong pixels differ by "
        f"more than {POINTS} points and by more than the share that rounding decides, or their RMSE by more than {RMSE}.",
        ["cells of both", "equal to the pixel", "greatest difference, points", "in", "beyond"],
        2, lambda adapter: [] if adapter is adapters[0] else differences(adapters[0], adapter))
    pivot("A frame by its size", "Milliseconds of a frame with its G-buffer: the GPU's clock, or * the CPU's where the "
          "GPU's cannot be trusted.", ["method"], lambda adapter: times(asked(adapter, "sizes"), size))
    pivot("A frame by the number of triangles", "The same in a city, at one size.",
          ["method"], lambda adapter: times(asked(adapter, "city"), triangles))
    add("Longest passes", "Pass with the greatest 95th percentile of its GPU time: what a driver's watchdog sees.",
        ["pass", "method", "scene", "viewport", "ms"], 6, longest)
    return "\n".join([*lines, ""])


def ms(time):
    digits = next((digits for least, digits in ((99.95, 0), (9.995, 1), (0.9995, 2)) if time >= least), 3)
    return f"{time:.{digits}f}"


def of(count, whole):
    return f"{count:,} of {whole:,}" if whole else "–"


def unique(values):
    return list(dict.fromkeys(values))


def abilities(adapter):
    gpu, machine, rows = adapter["adapter"], adapter["machine"], adapter["rows"]
    began = [row for row in rows if row["outcome"] != LACKING]
    not_done = [f"{row['row']}: {row['outcome']}" for row in began if row["outcome"] != "done"]
    small = ", small" if adapter["is_small"] else ""
    yield [
        *(gpu[key] for key in ("name", "backend", "driver", "device_type")),
        f"{machine['processor']}, {machine['cores']} cores",
        f"{len(began)}{small}, {max((row['date'] for row in rows), default='')}",
        "; ".join(not_done) or "–",
        "yes" if adapter["features"]["ray_query"] else "no",
        "no" if "gpu_unavailable" in gpu else "yes",
    ]


def exactness(adapter):
    def hard(*names):
        verdicts = [verdict for row in adapter["rows"] if row["row"] in names for verdict in row["verdicts"]]
        return of(verdicts.count("pass"), verdicts.count("pass") + verdicts.count("fail"))

    def bits(*names):
        pairs = [pair for row in adapter["rows"] if row["row"] in names for pair in row["alike"]]
        return of(sum(pair[2] for pair in pairs), sum(operator.mul(*pair[0]["viewport"]) for pair in pairs))

    exact = [run for run in ran(adapter) if is_exact(run)]
    nsm = [run for run in ran(adapter) if run["preset"] == "nsm"]
    yield [
        adapter["name"],
        hard("hard", "hard_area"),
        hard("hard_ray_query"),
        of(sum(map(outside_band, exact)), facing(exact)),
        bits("park", "lamps"),
        bits("area"),
        of(sum(map(wrong, nsm)), facing(nsm)),
    ]


def differences(first, adapter):
    both = list(beside(first, adapter))
    # Of equal ones the last.
    worst = max(reversed(both), key=lambda pair: pair[3], default=None)
    beyond = [place(one) for one, other, _, _, far in both if far or abs(rmse(one) - rmse(other)) > RMSE]
    yield [
        adapter["name"],
        f"{len(both):,}",
        f"{sum(is_equal for _, _, is_equal, *_ in both):,}",
        *([f"{worst[3]:.4f}", place(worst[0])] if worst else "––"),
        "; ".join(beyond) or "–",
    ]


def times(runs, key):
    def time(run):
        return "cannot" if "unavailable" in run else ms(frame_ms(run)) + ("" if run["frame"]["gpu_ms"] else "*")

    for method in unique(run["preset"] for run in runs):
        yield [f"`{method}`"], {key(run): time(run) for run in runs if run["preset"] == method}


def longest(adapter):
    timed = [(longest_pass(run), run) for run in ran(adapter) if longest_pass(run)]
    timed.sort(key=lambda it: it[0])
    # The longest of each pass, and of these the first three.
    each = {(run["preset"], name): (time, run) for (time, name), run in timed}
    for (method, name), (time, run) in sorted(each.items(), key=lambda it: -it[1][0])[:3]:
        scene = f"{run['scene']['name']}, {triangles(run)}"
        yield [adapter["name"], f"`{name}`", f"`{method}`", scene, size(run), ms(time)]


# Checks.


def own_faults(adapter):
    for row in adapter["rows"]:
        if row["outcome"] not in ("done", LACKING):
            said = (row["folder"] / "stderr.txt").read_text(errors="replace").split("\n")
            yield f"{row['row']}: {row['outcome']}: {' / '.join([line for line in said if line.strip()][-3:])}"
        for one, other, differing in row["alike"]:
            if differing:
                yield f"{one['preset']} and {other['preset']} on {one['view']}: {differing} pixels differ"
    for run in ran(adapter):
        if is_exact(run) and outside_band(run):
            yield f"{run['row']}, {place(run)}: {outside_band(run)} wrong pixels outside the band"


def faults_beside(both, must_be_equal):
    for one, other, is_equal, _, far in both:
        where = f"{one['row']}, {place(one)}"
        if must_be_equal and not is_equal:
            yield f"{where}: {wrong(other)} of {facing([other])} wrong, not {wrong(one)} of {facing([one])}"
        if is_exact(one) and far:
            yield f"{where}: {far:.3f} points apart"
    # A rasteriser that snaps corners to a coarser grid shifts edges in a map, in one view to the
    # better, in the next to the worse.
    for row, method in unique((one["row"], one["preset"]) for one, *_ in both):
        pairs = [pair[:2] for pair in both if (pair[0]["row"], pair[0]["preset"]) == (row, method)]
        apart = abs(operator.sub(*map(points, zip(*pairs))))
        if apart > POINTS:
            yield f"{row}, {method}: {apart:.3f} points apart over all cells"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folders", nargs="+", type=Path, metavar="DIR")
    parser.add_argument("--out", type=Path, help="folder for adapters.md")
    parser.add_argument("--equal", default="", metavar="DRIVER")
    args = parser.parse_args()
    adapters = [read(folder) for folder in args.folders]
    if args.out:
        args.out.mkdir(parents=True, exist_ok=True)
        (args.out / "adapters.md").write_text(markdown(adapters))
    failed, is_met = 0, not args.equal
    for adapter in adapters:
        is_equal = bool(args.equal) and args.equal in adapter["adapter"]["driver"]
        is_met |= is_equal
        found, both = list(own_faults(adapter)), []
        if adapter is not adapters[0]:
            both = list(beside(adapters[0], adapter))
            found += faults_beside(both, is_equal) if both else ["no cell in common with the first adapter"]
        failed += len(found)
        print(f"{adapter['name']}: {len(adapter['rows'])} rows, {len(ran(adapter))} cells, {len(found)} faults")
        if both:
            one, _, _, apart, _ = max(both, key=lambda pair: pair[3])
            print(f"  most points apart in a cell: {apart:.3f}, {one['row']}, {place(one)}")
        print("".join(f"  FAILED {fault}\n" for fault in found), end="")
    if not is_met:
        failed += 1
        print(f"FAILED of {len(adapters)} adapters none has `{args.equal}`")
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
