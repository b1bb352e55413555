# SPDX-License-Identifier: MIT
"""What compressed and other formats cost: LAZ against LAS and its codec alone, threads, laspy with lazrs, nanoflann, little memory, PCD, E57 and PTX.

The points of a generated cloud, in the order of a scan, with the attributes of an airborne one. All programs run in turn, and every answer
is checked before its time counts. Reading is timed inside the programs: it is without the start of Python, and from the page cache."""
import argparse
import datetime
import json
import os
import pathlib
import statistics
import subprocess
import sys

import formats_table
import processes
from processes import ROOT

READS = [".las", ".laz", ".pcd", ".e57", ".ptx", ".ply"]


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench formats", description=__doc__.split("\n")[0])
    parser.add_argument("--shape", default="terrain")
    parser.add_argument("--size", default="5M", help="points (default 5M)")
    parser.add_argument("--large", default="20M", help="points of the run within --memory as LAZ (default 20M; 0: none)")
    parser.add_argument("--memory", default="256M", help="budget of that run (default 256M)")
    parser.add_argument("--order", choices=["random", "scan"], default="scan", help="of the points in the files (default scan)")
    parser.add_argument("--repeat", type=int, default=3, help="timed runs of each program (default 3)")
    parser.add_argument("-k", type=int, default=8)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>-formats.json)")
    parser.add_argument("--table", nargs="+", type=pathlib.Path, metavar="RESULT", help="only write docs/performance.md's table from these results")
    return parser.parse_args()


class Programs:
    """The programs on one cloud; each call is one run and returns its figures."""

    def __init__(self, options, size):
        self.options = options
        ply = processes.cloud(options, options.shape, size, options.order)
        self.python = ROOT / "build/python/bin/python"
        processes.run([self.python, ROOT / "bench/formats/point_files.py", ply, options.work])
        self.files = {suffix: ply.with_suffix(suffix) for suffix in READS}
        self.points = processes.points(size)

    def output(self, name):
        return self.options.work / f"formats-{name}"

    def said(self, *command):
        """Returns the figures that a program which times itself prints as JSON."""
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        if done.returncode != 0:
            sys.exit(f"script/bench formats: {' '.join(map(str, command))}: {done.stderr.strip()}")
        return json.loads(done.stdout) if done.stdout else {}

    def normals(self, source, target, *options):
        return processes.run([self.options.build / "cli/pointsweep", "normals", self.files[source], self.output(target), "-k", self.options.k,
                              "--threads", self.options.threads, "--temp-dir", self.options.work, "--no-provenance", "--force", "--quiet", *options])

    def nanoflann(self, target):
        return processes.run([self.options.build / "bench/nanoflann_normals", self.files[".las"], self.output(target), "-k", self.options.k,
                              "--threads", self.options.threads, "--order", "permuted"])

    def codec(self, path, threads):
        return self.said(self.options.build / "bench/codec_alone", path, threads)

    def read(self, suffix, threads=None):
        return self.said(self.options.build / "bench/read_points", self.files[suffix], threads or self.options.threads)

    def laspy(self, suffix):
        return self.said(self.python, ROOT / "bench/formats/laspy_read.py", self.files[suffix])

    def require_same_records(self, *names):
        self.said(self.python, ROOT / "bench/formats/laspy_read.py", *map(self.output, names))

    def require_same_normals(self, *names):
        command = [self.options.build / "bench/compare_normals", *map(self.output, names)]
        if (done := subprocess.run(command, capture_output=True, text=True)).returncode != 0:
            sys.exit(f"script/bench formats: the normals of {names[1]} differ from those of {names[0]}: {done.stdout}{done.stderr}")


def turn(programs):
    """Runs each program once. Returns figures by label."""
    threads = programs.options.threads
    runs = {"normals LAS to LAS": programs.normals(".las", "las.las"), "normals LAZ to LAZ": programs.normals(".laz", "laz.laz"),
            "normals LAZ to LAS": programs.normals(".laz", "laz.las")}
    programs.require_same_records("las.las", "laz.laz")
    programs.require_same_records("las.las", "laz.las")
    for count in sorted({1, 2, threads}):
        runs[f"decode LAZ, {count} threads"] = programs.codec(programs.files[".las"], count)["decode"]
        runs[f"encode LAZ with normals, {count} threads"] = programs.codec(programs.output("las.las"), count)["encode"]
        runs[f"read .laz, {count} threads"] = programs.read(".laz", count)
    for suffix in READS:
        runs[f"read {suffix}"] = programs.read(suffix)
    runs["laspy reads .laz"] = programs.laspy(".laz")
    runs["nanoflann LAS to LAS"] = programs.nanoflann("nanoflann.las")
    programs.require_same_normals("las.las", "nanoflann.las")
    return runs


def check_reads(programs, runs):
    """Ends the program unless all readers find all points and the same bounds. LAS and LAZ have bounds of their own, which are rounded."""
    for label, figures in runs.items():
        if "bounds" not in figures:
            continue
        base = runs["read .las" if ".la" in label else "read .ply"]
        if (figures["points"], figures["bounds"]) != (programs.points, base["bounds"]):
            sys.exit(f"script/bench formats: '{label}' gives {figures} instead of {base}")


def measure(programs):
    turns = []
    for _ in range(programs.options.repeat):
        turns.append(turn(programs))
        check_reads(programs, turns[-1])
    return [{"program": label, "runs": [runs[label] for runs in turns], "median": median([runs[label] for runs in turns])} for label in turns[0]]


def median(runs):
    return {figure: statistics.median(run[figure] for run in runs) for figure in runs[0] if figure != "bounds"}


def within_memory(options):
    """Compares normals of a large LAZ file within --memory with a run without a limit; both outputs must have the same bytes."""
    programs = Programs(options, options.large)
    free, limited = programs.normals(".laz", "free.laz"), programs.normals(".laz", "limited.laz", "--memory", options.memory)
    if not processes.same_bytes(programs.output("free.laz"), programs.output("limited.laz")):
        sys.exit(f"script/bench formats: --memory {options.memory} changes the bytes of the output")
    return {"points": programs.points, "memory": options.memory, "free": free, "limited": limited}


def main():
    options = arguments()
    if options.table:
        formats_table.write([json.loads(path.read_text()) for path in options.table], options.table)
        return
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    programs = Programs(options, options.size)
    today, commit = datetime.date.today().isoformat(), processes.commit()
    result = {"date": today, "commit": commit, "compiler": processes.compiler(options.build), "machine": processes.machine(),
              "threads": options.threads, "shape": options.shape, "order": options.order, "points": programs.points, "k": options.k,
              "rows": measure(programs)}
    if processes.points(options.large):
        result["large"] = within_memory(options)
    for path in options.work.glob("formats-*"):
        path.unlink()
    output = options.output or ROOT / "bench/results" / f"{today}-{commit}-formats.json"
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(json.dumps(result, indent=1) + "\n")
    print(formats_table.of(result) + f"\n{output}")


if __name__ == "__main__":
    main()
