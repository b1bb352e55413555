# SPDX-License-Identifier: MIT
"""The overhead of a run over the work that no run can avoid: normals (k = 8, in memory, one thread) against the bare parts.

The parts are measured alone, on one thread: copying the same bytes, a radix sort of the same keys, the search kernel
on 112 candidates a point that are in cache, about as many as a query meets; and, named apart, the kernel of Equation 1."""
import argparse
import json
import pathlib
import statistics
import subprocess
import sys

import processes
from processes import ROOT


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench limits", description=__doc__.split("\n")[0])
    parser.add_argument("--shapes", nargs="+", default=["statue", "terrain", "tls"])
    parser.add_argument("--sizes", nargs="+", default=["5M"])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="where to write the numbers as JSON")
    return parser.parse_args()


def bare(options, cloud, output):
    done = subprocess.run([options.build / "bench/bare_parts", cloud, str(output.stat().st_size), options.work / "scratch"],
                          capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"script/bench limits: {done.stderr.strip()}")
    return json.loads(done.stdout)


def measure(options, shape, size):
    cloud, output = processes.cloud(options, shape, size), options.work / "output.ply"
    command = [options.build / "cli/pointsweep", "normals", cloud, output, "-k", 8, "--threads", 1, "--force", "--quiet"]
    whole, parts = [], []
    for _ in range(options.repeat):
        whole.append(processes.run(command)["cpu_seconds"])
        parts.append(bare(options, cloud, output))
    output.unlink()
    median = {part: statistics.median(p[part] for p in parts) for part in ("copy", "sort", "search", "normals")}
    return {"shape": shape, "points": processes.points(size), "whole": statistics.median(whole), **median}


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    rows = [measure(options, shape, size) for size in options.sizes for shape in options.shapes]
    print(f"{'cloud':<14}{'whole':>8}{'copy':>8}{'sort':>8}{'search':>8}{'normals':>9}   whole over copy + sort + search (+ normals)")
    for row in rows:
        three = row["copy"] + row["sort"] + row["search"]
        row["multiple"], row["multiple_with_normals"] = row["whole"] / three, row["whole"] / (three + row["normals"])
        cloud = f"{row['shape']} {row['points'] / 1e6:g}M"
        print(f"{cloud:<14}{row['whole']:>8.2f}{row['copy']:>8.2f}{row['sort']:>8.2f}{row['search']:>8.2f}{row['normals']:>9.2f}   "
              f"{row['multiple']:.2f} ({row['multiple_with_normals']:.2f})")
    if options.output:
        options.output.write_text(json.dumps({"commit": processes.commit(), "machine": processes.machine(), "rows": rows}, indent=1) + "\n")


if __name__ == "__main__":
    main()
