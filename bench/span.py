# SPDX-License-Identifier: MIT
"""Predicts the speed on more cores: records every task of a run and schedules the same tasks on other numbers of workers.

Each case runs for 1, 2, 4, 16 and 64 planned threads, by which the run divides its work; only the cores of this machine
execute it. Then each record is replayed (bench/span/replay.py), and the predictions for one thread and for all cores of
this machine are compared with the clock. A prediction that is off by more than 10 % means that the machine was busy."""
import argparse
import contextlib
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import time

import committed
import processes
from processes import ROOT

sys.path.insert(0, str(ROOT / "bench/span"))
import replay  # noqa: E402

CHAINS = {
    "normals": ("statue", ["normals", "{cloud}", "{out}.ply", "-k", "8"]),
    "normals-256M": ("statue", ["normals", "{cloud}", "{out}.ply", "-k", "8", "--memory", "256M", "--temp-dir", "{work}"]),
    "splats": ("statue", ["run", "{cloud}", "{out}.ply", "--pipeline", "knn(k=8) | normals | curvature | splats"]),
    "sor": ("statue", ["run", "{cloud}", "{out}.ply", "--pipeline", "knn(k=8) | sor | where(outlier == 0) | normals"]),
    "ground": ("terrain", ["run", "{cloud}", "{out}.ply", "--pipeline", "ground | height"]),
    "components": ("statue", ["run", "{cloud}", "{out}.ply", "--pipeline", "knn(k=8) | components"]),
    "orient": ("statue", ["run", "{cloud}", "{out}.ply", "--pipeline", "knn(k=8) | normals | orient"]),
    "poisson": ("terrain", ["run", "{cloud}", "{out}.ply", "--pipeline", "poisson(0.5)"]),
    "voxel": ("terrain", ["run", "{cloud}", "{out}.ply", "--pipeline", "voxel(0.5)"]),
    "laz": ("terrain", ["normals", "{cloud}", "{out}.laz", "-k", "8"]),
}


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench span", description=__doc__.split("\n")[0])
    parser.add_argument("--cases", nargs="+", default=["normals"], choices=CHAINS)
    parser.add_argument("--size", default="5M", help="points of each cloud")
    parser.add_argument("--planned", nargs="+", type=int, default=[1, 2, 4, 16, 64], help="numbers of threads to record for")
    parser.add_argument("--repeat", type=int, default=2, help="records for each; the one of the least CPU time counts")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="where to write the numbers as JSON")
    parser.add_argument("--table", type=pathlib.Path, nargs="+", help="make the table of docs/performance.md from these results instead")
    return parser.parse_args()


def run(words, program, threads, environment):
    """Returns the begin and end of the process in ns. The output does not exist before, since replacing it takes the system time."""
    pathlib.Path(words[2]).unlink(missing_ok=True)
    begin = time.monotonic_ns()
    done = subprocess.run([program, *words, "--threads", str(threads), "--quiet"], env={**os.environ, **environment})
    if done.returncode != 0:
        sys.exit(f"script/bench span: status {done.returncode} from: {' '.join(map(str, [program, *words]))}")
    return begin, time.monotonic_ns()


def recorded(options, words, planned, path):
    """CPU and wall seconds of a recorded run, and seconds that its process takes before and after the record."""
    environment = {"SPAN_TRACE": str(path), "SPAN_REAL": str(min(planned, os.cpu_count()))}
    begin, end = run(words, options.build / "bench/pointsweep_traced", planned, environment)
    with open(path, "rb") as file:
        head = json.loads(file.read(struct.unpack("<8sQ", file.read(16))[1]))
        file.seek(-8, os.SEEK_END)
        written, = struct.unpack("<Q", file.read(8))
    return head["process_cpu"] / 1e9, (head["wall_begin"] - begin + end - written) / 1e9


def measure(options, name, folder):
    shape, words = CHAINS[name]
    names = {"cloud": processes.cloud(options, shape, options.size), "out": folder / "out", "work": folder}
    words = [word.format(**names) for word in words]
    tool = options.build / "cli/pointsweep"
    run(words, tool, os.cpu_count(), {})  # brings the input into the page cache
    best, outside = {}, []
    for turn in range(options.repeat):
        for planned in options.planned:
            path = folder / f"record-{planned}-{turn}"
            cpu, around = recorded(options, words, planned, path)
            outside.append(around)
            best[planned] = min(best.get(planned, (cpu, path)), (cpu, path))
            for other in folder.glob(f"record-{planned}-*"):
                if other != best[planned][1]:
                    other.unlink()
    row = {"case": name, "points": processes.points(options.size), "cpu_seconds": {p: cpu for p, (cpu, _) in best.items()},
           **replay.replayed([path for _, path in best.values()], min(outside), sorted({*replay.WORKERS, os.cpu_count()}))}
    for threads in sorted({1, os.cpu_count()}):
        clock = min((end - begin) / 1e9 for begin, end in (run(words, tool, threads, {}) for _ in range(options.repeat)))
        predicted = row["workers"][threads]["wall"]
        row["text"] += f"\n{threads} threads: predicted {predicted:.3f} s, by the clock {clock:.3f} s, {predicted / clock - 1:+.1%}"
        row.setdefault("clock", {})[threads] = clock
    return row


def table(result):
    head = "| chain | points |" + "".join(f" {p} cores |" for p in replay.WORKERS[1:]) + " off by |\n"
    lines = []
    for row in result["rows"]:
        off = max(abs(row["workers"][threads]["wall"] / clock - 1) for threads, clock in row["clock"].items())
        gains = "".join(f" {row['workers'][str(p)]['speedup']:.1f} |" for p in replay.WORKERS[1:])
        lines.append(f"| {row['case']} | {row['points'] / 1e6:g}M |{gains} {off:.0%} |\n")
    return head + "|---" * (len(replay.WORKERS) + 2) + "|\n" + "".join(lines)


def main():
    options = arguments()
    if options.table:
        text = "".join(f"{committed.where(result)}, {committed.names([path])}.\n\n{table(result)}\n"
                       for result, path in zip(committed.read(options.table), options.table))
        return committed.write_table("span", text)
    options.work.mkdir(parents=True, exist_ok=True)
    options.work, rows = options.work.resolve(), []
    for name in options.cases:
        with contextlib.ExitStack() as stack:
            folder = pathlib.Path(tempfile.mkdtemp(prefix="span-", dir=options.work))
            stack.callback(shutil.rmtree, folder)
            rows.append(measure(options, name, folder))
            print(f"== {name}, {options.size} points\n{rows[-1]['text']}\n", flush=True)
    print(f"{'case':<14}" + "".join(f"{f'of {p}':>8}" for p in replay.WORKERS[1:]))
    for row in rows:
        print(f"{row['case']:<14}" + "".join(f"{row['workers'][p]['speedup']:>8.1f}" for p in replay.WORKERS[1:]))
        del row["text"]
    if options.output:
        committed.write(options.output, committed.begun(rows=rows))


if __name__ == "__main__":
    main()
