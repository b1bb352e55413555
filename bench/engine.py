# SPDX-License-Identifier: MIT
"""The engine compared with itself, from file to file: threads, memory, orders, chains, statistics, instruction sets, files, the paper's
algorithm.

Whole processes run in turns. Rows with one answer must have the same bytes before their times count. A ratio to another row is the median
of the ratios of all turns. Times of search and operators are sums over threads, divided by the number of threads."""
import argparse
import json
import os
import pathlib
import subprocess
import sys

import processes
import turns
from processes import ROOT
from turns import Case, Turns

CURVATURE = "knn(k=8) | normals | curvature | splats"
SPLATS = "normal,splat_axis,splat_length,splat_ratio"


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench engine", description=__doc__.split("\n")[0])
    parser.add_argument("--parts", nargs="+", choices=list(PARTS), default=list(PARTS), help="what to measure (default: all)")
    parser.add_argument("--shape", default="statue")
    parser.add_argument("--sizes", nargs="+", default=["5M"], help="points, e.g. 500k 20M (default 5M)")
    parser.add_argument("--reference-size", default="200k", help="points for the paper's algorithm, which is slow (default 200k)")
    parser.add_argument("--repeat", type=int, default=3, help="timed runs of each (default 3)")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--memory", default="256M", help="the small budget (default 256M)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="where to write the numbers as JSON")
    return parser.parse_args()


def tool(options, verb, cloud, *words, threads=None):
    return lambda output: [options.build / "cli/pointsweep", verb, cloud, output, "--threads", threads or options.threads, *words]


def threads(options, cloud):
    """Returns the rows for one, two, four and so on, up to all threads."""
    counts = sorted({options.threads, *(2**i for i in range(options.threads.bit_length()))})
    return [Case(f"normals, {n} thread{'s' if n > 1 else ''}", tool(options, "normals", cloud, "-k", 8, threads=n), over="normals, 1 thread" if n > 1 else None,
                 in_memory=True) for n in counts]


def memory(options, cloud):
    """Returns the rows for orders of the output and memory budgets. An output in the order of the sweep is not put into the order of the input."""
    def case(order, budget, **fields):
        words = ["-k", 8, "--order", order] + (["--memory", budget] if budget else [])
        return Case(f"--order {order}, {'--memory ' + budget if budget else 'in memory'}", tool(options, "normals", cloud, *words),
                    answer=order, in_memory=not budget, **fields)
    return [case("sweep", None), case("input", None, over="--order sweep, in memory"),
            case("sweep", options.memory, over="--order sweep, in memory"), case("input", options.memory, over="--order input, in memory")]


def chains(options, cloud):
    """Returns the rows for chains, each also with one thread, which must give the same bytes. Attributes made per point take 84 bytes at
    the end of the longest chain, 32 if only splats are kept, 12 after normals."""
    chain = CURVATURE.split(" | ", 1)[1]
    every = [("normals", "normals", ["-k", 8]), ("curvature", "curvature", ["-k", 8]), (chain, "run", ["--pipeline", CURVATURE]),
             ("the same, splats kept", "run", ["--pipeline", CURVATURE, "--keep", SPLATS]), ("fair -k 64", "fair", ["-k", 64])]
    cases = []
    for label, verb, words in every:
        cases.append(Case(label, tool(options, verb, cloud, *words), over="normals" if cases else None, answer=label))
        cases.append(Case(f"{label}, 1 thread", tool(options, verb, cloud, *words, threads=1), answer=label, timed=False))
    return cases


def instruction_sets(options, cloud):
    """Returns the rows for instruction sets, without emulated vectors. The first is the best one, which the tool uses."""
    program = options.build / "bench/with_instruction_set"
    names = subprocess.run([program], capture_output=True, text=True, check=True).stdout.split()
    names = [name for name in names if name not in ("EMU128", "SCALAR")] or names
    cases = [Case(name, lambda output, name=name: [program, name, cloud, output, 8, options.threads],
                  over=names[0] if name != names[0] else None, tool=False, says=name) for name in names]
    return [Case("normals", tool(options, "normals", cloud, "-k", 8), timed=False), *cases]


def statistics(options, cloud):
    """Returns the rows for statistics of neighbours, compared with normals of as many neighbours."""
    every = ["z_mean", "z_median", "z_range", "z_deviation", "z_majority", "count"]
    return [Case("normals -k 16", tool(options, "normals", cloud, "-k", 16), answer="normals"),
            *(Case(f"statistics({one}) -k 16", tool(options, "run", cloud, "--pipeline", f"knn(k=16) | statistics({one})"), over="normals -k 16", answer=one) for one in every)]


def copies(options, cloud):
    """Returns the rows for copies of files, as bytes and point by point, which must give the same bytes. `convert` is compared with the
    reader and the writer alone."""
    program, suffix = options.build / "bench/copy_points", cloud.suffix[1:]
    plain, alone = f"{suffix}: bytes, 4 MB at a time", f"{suffix}: reader and writer"
    return [Case(plain, lambda output: [program, "--plain", cloud, output], tool=False),
            Case(f"{suffix}: cp", lambda output: ["cp", cloud, output], over=plain, tool=False),
            Case(alone, lambda output: [program, cloud, output], over=plain, tool=False),
            Case(f"{suffix}: convert", tool(options, "convert", cloud, "--no-provenance"), over=alone)]


def reference(options, cloud):
    """The paper's algorithm has one thread and misses some neighbours; the time it takes to count these cases is left out."""
    one = "normals, 1 thread"
    return [Case(one, tool(options, "normals", cloud, "-k", 8, threads=1)),
            Case(f"normals, {options.threads} threads", tool(options, "normals", cloud, "-k", 8), over=one),
            Case("--engine reference", tool(options, "normals", cloud, "-k", 8, "--engine", "reference", threads=1), over=one,
                 check=turns.compare_normals(options))]


PARTS = {"threads": threads, "memory": memory, "chains": chains, "statistics": statistics, "sets": instruction_sets, "copies": copies, "reference": reference}


def measure(options, part, size):
    print(f"script/bench engine: {part}, {options.shape} {size}", file=sys.stderr)
    rows = []
    for file_format in ("ply", "las") if part == "copies" else ("ply",):
        cloud = processes.cloud(options, options.shape, size, file_format=file_format)
        cases = PARTS[part](options, cloud)
        rows += Turns(options, cases, cloud.suffix).rows(part=part, shape=options.shape, points=processes.points(size))
    for row in rows:
        if row["program"] == "fair -k 64":
            row["cpu_ns_per_point_and_neighbor"] = row["median"]["cpu_seconds"] * 1e9 / row["points"] / 64
    return rows


def remarks(row):
    median, ratio = row["median"], row.get("ratio", {})
    if row["part"] == "threads" and "busy_seconds" in ratio:
        yield f"{1 / ratio['wall_seconds']:.1f} times as fast as one thread, search and operators {1 / ratio['busy_seconds']:.1f}"
    if row["part"] in ("threads", "memory"):
        yield (f"order {median['order_seconds'] / median['total_seconds']:.0%}, write {median['write_seconds'] / median['total_seconds']:.0%}"
               " of the wall time")
    if median.get("spilled_bytes"):
        yield f"spilled {median['spilled_bytes'] / 1e6:.0f} MB"
    if "cpu_ns_per_point_and_neighbor" in row:
        yield f"{row['cpu_ns_per_point_and_neighbor']:.1f} CPU ns per point and neighbour"
    if row["remark"]:
        yield row["remark"]


def print_table(rows):
    part = None
    for row in rows:
        if (row["part"], row["points"]) != part:
            part = row["part"], row["points"]
            label = f"{row['part']}: {row['shape']} {row['points'] / 1e6:g}M"
            print(f"\n{label:<36}{'wall s':>9}{'CPU s':>9}{'peak MB':>9}{'wall':>8}{'CPU':>7}  over")
        m, ratio = row["median"], row.get("ratio")
        ratios = f"{ratio['wall_seconds']:>8.2f}{ratio['cpu_seconds']:>7.2f}  {row['over']:<26}" if ratio else " " * 43
        print(f"{row['program']:<36}{m['wall_seconds']:>9.2f}{m['cpu_seconds']:>9.2f}{m['peak_rss_bytes'] / 1e6:>9.0f}{ratios} {'; '.join(remarks(row))}".rstrip())


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    rows = []
    for part in options.parts:
        for size in [options.reference_size] if part == "reference" else options.sizes:
            rows += measure(options, part, size)
    print_table(rows)
    if options.output:
        result = {"commit": processes.commit(), "compiler": processes.compiler(options.build), "machine": processes.machine(),
                  "threads": options.threads, "memory": options.memory, "rows": rows}
        options.output.write_text(json.dumps(result, indent=1) + "\n")


if __name__ == "__main__":
    main()
