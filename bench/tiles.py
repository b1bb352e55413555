# SPDX-License-Identifier: MIT
"""The cost of ordering: normals of a folder of LAZ tiles, which are ordered by their boxes, and of the same points as one LAS file in
random order, which are distributed.

Tiles lie in a row along x. All runs have the same budget and take turns; the normals of the tiles are compared with those of one cloud of them, made in memory."""
import argparse
import json
import os
import pathlib
import statistics
import subprocess
import sys

import processes
from processes import ROOT


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench tiles", description=__doc__.split("\n")[0])
    parser.add_argument("--tiles", type=int, default=16)
    parser.add_argument("--size", default="2M", help="points of a tile (default 2M)")
    parser.add_argument("--memory", default="256M", help="budget of each run (default 256M)")
    parser.add_argument("--repeat", type=int, default=1, help="timed runs of each kind (default 1)")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    return parser.parse_args()


def make_inputs(options):
    """Makes tiles/tile00.laz, ... and random.las with tile_files.py."""
    folder = options.work / f"tiles-{options.tiles}-{options.size}"
    if not (folder / "random.las").exists():
        folder.mkdir(parents=True, exist_ok=True)
        python = ROOT / "build/python/bin/python"
        subprocess.run([python, ROOT / "bench/formats/tile_files.py", folder, str(options.tiles), str(processes.points(options.size))], check=True)
    return folder


def normals(options, source, target, *more):
    """Runs once and returns wall and CPU time, peak memory, and the bytes and order from the statistics."""
    stats = options.work / "tiles-stats.json"
    figures = processes.run([options.build / "cli/pointsweep", "normals", source, target, "--threads", options.threads, "--temp-dir", options.work,
                             "--no-provenance", "--force", "--quiet", "--stats", stats, *more])
    said = json.loads(stats.read_text())
    return {**figures, **{f"bytes_{kind}": said["bytes"][kind] for kind in ("spilled", "spilled_ordering", "spilled_decoding")}, "ordering": said["ordering"]}


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    folder = make_inputs(options)
    budget = ("--memory", options.memory)
    runs = {"tiles, LAZ": [], "random order, LAS": []}
    for _ in range(options.repeat):
        runs["tiles, LAZ"].append(normals(options, folder / "tiles", options.work / "tiles-out.las", *budget))
        runs["random order, LAS"].append(normals(options, folder / "random.las", options.work / "tiles-random.las", *budget))
    normals(options, folder / "tiles", options.work / "tiles-free.las", "--memory", "8G")
    if not processes.same_bytes(options.work / "tiles-out.las", options.work / "tiles-free.las"):
        sys.exit(f"script/bench tiles: --memory {options.memory} changes the bytes of the output")
    for label, figures in runs.items():
        print(f"{label}: {figures[0]['ordering']}")
        for name in figures[0]:
            if name != "ordering":
                print(f"  {name:18} {statistics.median(run[name] for run in figures):,.2f}")
    for path in options.work.glob("tiles-*.las"):
        path.unlink()
    (options.work / "tiles-stats.json").unlink()


if __name__ == "__main__":
    main()
