#!/usr/bin/env python3
"""Measures a comparison as an array job of Slurm on two nodes of one core, kills a node and its task
in the middle, and compares cell by cell with the same comparison by one process. Then measures how
much faster two shards are than one, each with one rasteriser thread.

    scripts/shards.py --program target/release/skiagraph --out out/long-shards

Needs root on Debian, or Slurm. Fails if cells, errors or pictures differ, if no task was begun anew,
or if two shards are less than 1.7 times as fast.
"""

import argparse
import json
import os
import re
import resource
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

SLURM = Path(__file__).with_name("slurm.sh")
TASKS = 10
# One core for a task, the hierarchy and the reference too.
ONE_CORE = {"LP_NUM_THREADS": "1", "RAYON_NUM_THREADS": "1"}
GRID = (
    "rt light_buffer nsm crsm hybrid_pcf pcf vsm esm msm pssm --scene park --view all "
    "--size 64x64,96x96,128x128,128x64 --map-size 128 --frames 2 --warmup 0 --regime-frames 0"
).split()
# The same on all machines with one adapter and driver.
ANSWERS = (
    "cell fingerprint params pixels band wrong_surface area certain uncertain split wrong graded edges "
    "texels layer_jump facing_mismatch unavailable"
).split()


def run(*words, **environment):
    """Runs the program, and returns the seconds of CPU time that it took."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(words, env=os.environ | environment, text=True, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, words))}: exit {done.returncode}\n{done.stdout}{done.stderr}")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def asked(*words):
    return subprocess.run(words, text=True, capture_output=True, check=True).stdout


def kill_node(folder, node):
    """Kills a node's slurmd, the step of its running task, and the task."""
    jobs = asked("squeue", "-h", "-w", node, "-t", "R", "-o", "%A").split()
    mine = f"SLURMD_NODENAME={node}".encode()
    os.kill(int((folder / node / "pid").read_text()), signal.SIGKILL)
    killed = []
    for process in Path("/proc").glob("[0-9]*"):
        try:
            words = (process / "cmdline").read_bytes().replace(b"\0", b" ").decode(errors="replace")
            is_step = any(words.startswith(f"slurmstepd: [{job}.") for job in jobs)
            if is_step or mine in (process / "environ").read_bytes().split(b"\0"):
                os.kill(int(process.name), signal.SIGKILL)
                killed.append(words.strip()[:60])
        except (ProcessLookupError, PermissionError, FileNotFoundError):
            pass
    print(f"killed: the slurmd of {node}, and {len(killed)} processes of the tasks {jobs}")
    if not any(words.startswith("slurmstepd") for words in killed):
        sys.exit(f"no step ran on {node}: nothing was tried out")


def wait_for(what, is_there, seconds):
    end = time.monotonic() + seconds
    while not is_there():
        if time.monotonic() > end:
            sys.exit(f"{what}: not within {seconds} s\n{asked('squeue')}{asked('sinfo')}")
        time.sleep(0.2)


def by_slurm(program, out):
    """Measures all cells as an array job, of which a node is killed when a third is there."""
    plan, folder = out / "cells.jsonl", out / "slurm"
    run(program, "compare", *GRID, "--plan", plan)
    cells = json.loads(plan.read_text().splitlines()[0])["cells"]
    if cells < 200:
        sys.exit(f"{cells} cells are too few")
    os.environ["SLURM_CONF"] = asked(SLURM, "start", folder).strip()
    try:
        job = out / "job.sh"
        variables = " ".join(f"{name}={value}" for name, value in ONE_CORE.items())
        job.write_text(
            f'#!/bin/sh\nexec env {variables} {program} compare --cells {plan} --out {out / "sharded"} '
            f'--shard "$SLURM_ARRAY_TASK_ID/{TASKS}"\n'
        )
        log = f"--output={out}/task-%a.txt"
        words = ["sbatch", "--requeue", "--open-mode=append", f"--array=1-{TASKS}", log]
        number = asked(*words, "--parsable", job).strip()

        def measured():
            return len(list((out / "sharded" / "cells").glob("*.json")))

        wait_for("a third of the cells", lambda: measured() > cells // 3, 1200)
        kill_node(folder, "n2")
        is_lost = measured()
        wait_for("node n2 is down", lambda: "down" in asked("sinfo", "-h", "-n", "n2", "-o", "%T"), 120)
        subprocess.run([SLURM, "node", folder, "n2"], check=True)
        wait_for("the end of all tasks", lambda: not asked("squeue", "-h").strip(), 2400)
        told = asked("scontrol", "show", "job", number)
        restarts = sum(map(int, re.findall(r"Restarts=(\d+)", told)))
        states = set(re.findall(r"JobState=(\w+)", told))
        print(f"{cells} cells, {is_lost} were there when the node was lost; {restarts} task requeued")
        if restarts < 1 or states != {"COMPLETED"}:
            logs = "".join(path.read_text() for path in sorted(out.glob("task-*.txt")))
            sys.exit(f"restarts {restarts}, states {states}\n{logs}")
    finally:
        subprocess.run([SLURM, "stop", folder], check=False)


def runs(folder):
    """The runs of results by their cells, each once."""
    results = json.loads((folder / "results.json").read_text())
    every = [run for of in [results, *results.get("others", [])] for run in of["runs"]]
    found = {run["cell"]: run for run in every}
    if len(found) != len(every):
        sys.exit(f"{folder}: {len(every)} runs of {len(found)} cells")
    return found


def compare(whole, joined):
    """Compares cells, errors and pictures."""
    one, other = runs(whole), runs(joined)
    if one.keys() != other.keys():
        sys.exit(f"other cells: {one.keys() ^ other.keys()}")
    faults = []
    for cell, run in one.items():
        names = [name for name in ANSWERS if run.get(name) != other[cell].get(name)]
        faults += [f"{run['preset']} on {run['view']}: {name}" for name in names]
    pictures = {path.name for path in whole.glob("*.png")} | {path.name for path in whole.glob("*.svg")}
    for name in sorted(pictures):
        there = joined / name
        if not there.exists() or there.read_bytes() != (whole / name).read_bytes():
            faults.append(name)
    print(f"{len(one)} cells and {len(pictures)} pictures compared, {len(faults)} differ")
    if faults or not pictures:
        sys.exit("\n".join(faults[:20]) or "no pictures")


def speed(program, out):
    """Compares the CPU time of all cells with that of the slower half, which needs no idle machine."""
    plan = out / "cells.jsonl"
    words = [program, "compare", "--cells", plan, "--out"]
    whole = run(*words, out / "one", **ONE_CORE)
    halves = [run(*words, out / "two", "--shard", f"{half}/2", **ONE_CORE) for half in (1, 2)]
    ratio = whole / max(halves)
    load = os.getloadavg()[0]
    print(
        f"CPU time of one shard {whole:.1f} s, of two {halves[0]:.1f} s and {halves[1]:.1f} s: "
        f"{ratio:.2f} times as fast (load {load:.1f} on {os.cpu_count()} cores)"
    )
    if ratio < 1.7:
        sys.exit("two shards are less than 1.7 times as fast as one")


def main():
    arguments = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    arguments.add_argument("--program", type=Path, required=True)
    arguments.add_argument("--out", type=Path, required=True)
    arguments = arguments.parse_args()
    program, out = arguments.program.resolve(), arguments.out.resolve()
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    run(program, "compare", *GRID, "--out", out / "whole", **ONE_CORE)
    by_slurm(program, out)
    run(program, "merge", out / "sharded", "--out", out / "sharded")
    compare(out / "whole", out / "sharded")
    speed(program, out)


if __name__ == "__main__":
    main()
