# SPDX-License-Identifier: MIT
"""Normals of generated clouds, file to file: pointsweep and nanoflann in turn, whole processes.

Every answer is compared with that of pointsweep in memory before its time counts. CPU seconds are user + system of the
process and its threads; files stay in the page cache between runs, for all programs alike."""
import argparse
import datetime
import itertools
import json
import os
import pathlib
import statistics
import subprocess
import sys

import processes
from processes import ROOT, points


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench", description=__doc__.split("\n")[0])
    parser.add_argument("--shapes", nargs="+", default=["statue", "terrain", "tls"])
    parser.add_argument("--sizes", nargs="+", default=["1M", "5M", "20M"], help="points, e.g. 500k 20M")
    parser.add_argument("--repeat", type=int, default=3, help="timed runs of each program (default 3)")
    parser.add_argument("-k", nargs="+", type=int, default=[8])
    parser.add_argument("--orders", nargs="+", choices=["random", "scan"], default=["random"],
                        help="order of the points in the files: random, or line after line as a scanner writes them")
    parser.add_argument("--formats", nargs="+", choices=["ply", "las"], default=["ply"],
                        help="of input and output: PLY with float32 coordinates (default), LAS 1.4 with point format 6")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--memory", default="256M", help="budget of the out-of-core run (default 256M)")
    parser.add_argument("--only", nargs="+", help="names of contenders to run in addition to pointsweep in memory")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>.json)")
    return parser.parse_args()


def contenders(options, k):
    """Name -> command from an input and an output. The first is what the others are compared with."""
    sweep = [options.build / "cli/pointsweep", "normals"]
    sweep_end = ["-k", k, "--threads", options.threads, "--temp-dir", options.work, "--force", "--quiet"]
    flann_end = ["-k", k, "--threads", options.threads, "--order"]
    plain, native = options.build / "bench/nanoflann_normals", options.build / "bench/nanoflann_normals_native"
    all_of_them = {
        "pointsweep": lambda i, o: [*sweep, i, o, *sweep_end],
        f"pointsweep --memory {options.memory}": lambda i, o: [*sweep, i, o, *sweep_end, "--memory", options.memory],
        "nanoflann": lambda i, o: [plain, i, o, *flann_end, "file"],
        "nanoflann permuted": lambda i, o: [plain, i, o, *flann_end, "permuted"],
        "nanoflann permuted native": lambda i, o: [native, i, o, *flann_end, "permuted"],
    }
    return {n: c for n, c in all_of_them.items() if not options.only or n == "pointsweep" or n in options.only}


def compare(options, reference, output):
    done = subprocess.run([options.build / "bench/compare_normals", reference, output], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"script/bench: {output} differs from {reference}: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)["share"]


def measure(options, shape, size, order, file_format, k):
    cloud = processes.cloud(options, shape, size, order, file_format)
    programs = contenders(options, k)
    runs = {name: [] for name in programs}
    differ = {}
    reference, other = options.work / f"reference.{file_format}", options.work / f"output.{file_format}"
    for _ in range(options.repeat):
        for name, command in programs.items():
            output = reference if name == "pointsweep" else other
            output.unlink(missing_ok=True)
            figures = processes.run(command(cloud, output))
            differ[name] = compare(options, reference, output)
            runs[name].append(figures)
    for output in (reference, other):
        output.unlink(missing_ok=True)
    return [{"shape": shape, "points": points(size), "order": order, "format": file_format, "k": k, "program": name,
             "rows_that_differ": differ[name], "runs": runs[name],
             "median": {figure: statistics.median(r[figure] for r in runs[name]) for figure in runs[name][0]}}
            for name in programs]


def print_table(rows):
    """Ratios are of medians, to the pointsweep run in memory."""
    print(f"{'cloud':<34}{'program':<28}{'wall s':>9}{'CPU s':>9}{'Mpoints/s':>11}{'peak MB':>9}{'CPU ratio':>11}{'differ':>9}")
    base = {}
    for row in rows:
        m = row["median"]
        case = row["shape"], row["points"], row["order"], row["format"], row["k"]
        base.setdefault(case, m["cpu_seconds"])
        label = f"{row['shape']} {row['points'] / 1e6:g}M {row['order']} {row['format']} k={row['k']}"
        print(f"{label:<34}{row['program']:<28}"
              f"{m['wall_seconds']:>9.2f}{m['cpu_seconds']:>9.2f}{row['points'] / 1e6 / m['wall_seconds']:>11.2f}"
              f"{m['peak_rss_bytes'] / 1e6:>9.0f}{m['cpu_seconds'] / base[case]:>11.2f}"
              f"{row['rows_that_differ']:>9.1g}")


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    rows = []
    for size, shape, order, file_format, k in itertools.product(options.sizes, options.shapes, options.orders, options.formats, options.k):
        print(f"script/bench: {shape} {size}, {order} order, {file_format}, k = {k}", file=sys.stderr)
        rows += measure(options, shape, size, order, file_format, k)
    today, commit = datetime.date.today().isoformat(), processes.commit()
    result = {"date": today, "commit": commit, "compiler": processes.compiler(options.build), "machine": processes.machine(),
              "threads": options.threads, "rows": rows}
    output = options.output or ROOT / "bench/results" / f"{today}-{commit}.json"
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(json.dumps(result, indent=1) + "\n")
    print_table(rows)
    print(f"\n{output}")


if __name__ == "__main__":
    main()
