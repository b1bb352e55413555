# SPDX-License-Identifier: MIT
"""Searches within a radius: nanoseconds per neighbour on one thread, for 24 to 1,051 neighbours, against a grid and nanoflann.

All contenders must find the same neighbours. `pointsweep` and those called sorted give each list nearest first. With
--processes: CPU seconds of whole processes instead, in turn on one thread: normals of `statue` from file to file, within
radii that hold as many points, and of k = 64 and 256. nanoflann on permuted points does not sort. Answers are compared first."""
import argparse
import datetime
import json
import pathlib
import statistics
import subprocess
import sys

import processes as bench


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench radius", description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1M", help="points of the cloud (default 1M)")
    parser.add_argument("--neighbors", default="50M", help="neighbours found for each figure (default 50M)")
    parser.add_argument("--repeat", type=int, default=3, help="runs, of which the least counts (default 3)")
    parser.add_argument("--processes", action="store_true", help="normals from file to file instead of searches alone")
    parser.add_argument("--before", type=pathlib.Path, help="the pointsweep of another build, in the same turns (with --processes)")
    parser.add_argument("--work", type=pathlib.Path, default=bench.ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=bench.ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="JSON file for the result")
    return parser.parse_args()


# Radius on a statue of 1M points -> neighbours of a point. For other numbers of points the radii scale with the spacing.
STATUE = {0.00615: 24, 0.0102: 66, 0.0203: 262, 0.0407: 1051}


def processes(options):
    """Returns rows for whole processes run in turns: medians of user and system CPU seconds."""
    options.work.mkdir(parents=True, exist_ok=True)
    cloud = bench.cloud(options, "statue", options.size)
    closer = (bench.points("1M") / bench.points(options.size)) ** 0.5
    cases = [(f"{n} neighbours", ["--radius", f"{radius * closer:.6g}"]) for radius, n in STATUE.items()]
    cases += [(f"k = {k}", ["-k", k]) for k in (64, 256)]
    tool, ours = ["normals", "--threads", 1, "--temp-dir", options.work, "--force", "--quiet"], options.build / "cli/pointsweep"
    contenders = {"pointsweep": lambda words, to: [ours, *tool, *words, cloud, to]}
    if options.before:
        contenders["before"] = lambda words, to: [options.before, *tool, *words, cloud, to]
    flann = options.build / "bench/nanoflann_normals"
    contenders["nanoflann permuted"] = lambda words, to: [flann, cloud, to, *words, "--threads", 1, "--order", "permuted"]
    rows, outputs = [], {name: options.work / f"radius-{i}.ply" for i, name in enumerate(contenders)}
    for case, words in cases:
        seconds = {name: [] for name in contenders}
        for turn in range(options.repeat):
            for name, command in contenders.items():
                figures = bench.run(command(words, outputs[name]), options.work / "said.txt")
                seconds[name].append(figures["cpu_seconds"])
                if turn == 0:
                    check(options, name, outputs["pointsweep"], outputs[name])
        for name, cpu in seconds.items():
            rows.append({"case": case, "contender": name, "options": [str(word) for word in words],
                         "cpu_seconds": statistics.median(cpu), "turns": cpu})
    return rows


def check(options, name, ours, theirs):
    if name == "before" and not bench.same_bytes(ours, theirs):
        sys.exit("script/bench radius: the bytes are not those of before")
    done = subprocess.run([options.build / "bench/compare_normals", ours, theirs], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"script/bench radius: {name} makes other normals: {done.stdout}{done.stderr}")


def print_processes(options, rows):
    names = list(dict.fromkeys(row["contender"] for row in rows))
    print(f"normals of statue {options.size}, CPU s, one thread, medians of {options.repeat}")
    print(f"{'':<20}" + "".join(f"{name:>20}" for name in names) + f"{'ours / nanoflann':>20}")
    for case in dict.fromkeys(row["case"] for row in rows):
        cpu = {row["contender"]: row["cpu_seconds"] for row in rows if row["case"] == case}
        print(f"{case:<20}" + "".join(f"{cpu[name]:>20.2f}" for name in names) +
              f"{cpu['pointsweep'] / cpu['nanoflann permuted']:>20.2f}")


def searches(options):
    """Returns rows for searches alone: the fastest of several runs."""
    program = options.build / "bench/radius_searches"
    least = {}
    for _ in range(options.repeat):
        command = [program, str(bench.points(options.size)), str(bench.points(options.neighbors))]
        for line in subprocess.run(command, check=True, capture_output=True, text=True).stdout.splitlines():
            row = json.loads(line)
            key = row["contender"], row["wanted"]
            if key not in least or row["ns"] < least[key]["ns"]:
                least[key] = row
    return list(least.values())


def print_searches(options, rows):
    wanted = sorted({row["wanted"] for row in rows})
    print(f"{options.size} points, ns per neighbour, one thread, least of {options.repeat}")
    print(f"{'neighbours of a point':<24}" + "".join(f"{w:>10}" for w in wanted))
    for contender in dict.fromkeys(row["contender"] for row in rows):
        ns = {row["wanted"]: row["ns"] for row in rows if row["contender"] == contender}
        print(f"{contender:<24}" + "".join(f"{ns[w]:>10.2f}" for w in wanted))


def main():
    options = arguments()
    rows = processes(options) if options.processes else searches(options)
    print_processes(options, rows) if options.processes else print_searches(options, rows)
    if options.output:
        result = {"date": datetime.date.today().isoformat(), "commit": bench.commit(), "machine": bench.machine(),
                  "compiler": bench.compiler(options.build), "points": bench.points(options.size), "rows": rows}
        options.output.parent.mkdir(parents=True, exist_ok=True)
        options.output.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
