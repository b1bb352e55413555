# SPDX-License-Identifier: MIT
"""The overhead of the Python package: calls on arrays from C++ and from Python; and normals of a file as arrays, by the package, and by the
tool with laspy, which reads the output of the tool. Answers must have the same bytes before times count; the runs of one row alternate."""
import argparse
import json
import os
import pathlib
import subprocess
import sys

import committed
import processes
from committed import median
from processes import ROOT

TASKS = ("normals", "neighbors", "file")


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench binding", description=__doc__.split(":")[0])
    parser.add_argument("--shape", default="statue")
    parser.add_argument("--size", default="5M", help="points (default 5M)")
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=TASKS)
    parser.add_argument("--format", default="las", help="of the files (default las)")
    parser.add_argument("-k", type=int, default=16)
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--table", nargs="+", type=pathlib.Path, metavar="RESULT", help="only write bench/log.md's table from these results")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>-binding.json)")
    return parser.parse_args()


class Bench:
    def __init__(self, options):
        self.options = options
        self.tool = options.build / "cli/pointsweep"
        self.python = [ROOT / "build/python-package/bin/python", ROOT / "bench/binding/calls.py"]
        os.environ["PYTHONPATH"] = str(options.build / "python")
        self.cloud = options.work / f"binding-{options.shape}-{options.size}.{options.format}"
        if not self.cloud.exists():
            processes.run([self.tool, "generate", options.shape, self.cloud, "-n", processes.points(options.size), "--quiet"])

    def figures(self, command):
        done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE, text=True, check=True)
        return json.loads(done.stdout)

    def array(self):
        path = self.cloud.with_suffix(".f64")
        if not path.exists():
            code = "import sys, pointsweep as ps; ps.open(sys.argv[1]).run('decimate(1)', keep=['xyz'])['xyz'].astype(float).tofile(sys.argv[2])"
            subprocess.run([self.python[0], "-c", code, self.cloud, path], check=True)
        return path

    def calls(self, task):
        options, answers = self.options, [self.options.work / f"binding-{way}.bin" for way in ("cpp", "python")]
        runs = {"C++": [], "Python": []}
        for _ in range(options.repeat):
            for kept, program, answer in zip(runs.values(), ([options.build / "bench/array_calls"], self.python), answers):
                kept.append(self.figures([*program, task, self.array(), answer, options.k, options.threads]))
        return runs, answers

    def file(self, _):
        options, answers = self.options, [self.options.work / f"binding-{way}.bin" for way in ("laspy", "python")]
        made = options.work / f"binding-normals.{options.format}"
        tail = [options.k, options.threads]
        by_tool = [self.tool, "normals", self.cloud, made, "-k", options.k, "--threads", options.threads, "--quiet", "--force"]
        runs = {"tool, then laspy": [], "package": []}
        for repeated in range(options.repeat + 1):  # the first turn writes the answers and does not count
            targets = answers if repeated == 0 else ("", "")
            parts = [processes.run(by_tool), processes.run([*self.python, "laspy", made, targets[0], *tail])]
            whole = {figure: sum(part[figure] for part in parts) for figure in ("wall_seconds", "user_seconds", "cpu_seconds")}
            package = processes.run([*self.python, "package", self.cloud, targets[1], *tail])
            if repeated > 0:
                runs["tool, then laspy"].append({**whole, "peak_rss_bytes": max(part["peak_rss_bytes"] for part in parts)})
                runs["package"].append(package)
        return runs, answers

    def row(self, task):
        runs, answers = (self.file if task == "file" else self.calls)(task)
        if not processes.same_bytes(*answers):
            sys.exit(f"script/bench binding: the answers of {task} differ")
        return {"task": task, "runs": runs}


LABELS = {"normals": "normals of an array", "neighbors": "neighbours of an array", "file": "normals of a file to arrays (whole processes)"}


def table(rows):
    yield "| task | first | second | CPU s | CPU s | ratio | in its own code | wall s | wall s |\n|---|---|---|---|---|---|---|---|---|\n"
    for row in rows:
        (first, a), (second, b) = row["runs"].items()
        cpu, user, wall = ([median(runs, figure) for runs in (a, b)] for figure in ("cpu_seconds", "user_seconds", "wall_seconds"))
        yield (f"| {LABELS[row['task']]} | {first} | {second} | {cpu[0]:.2f} | {cpu[1]:.2f} | {cpu[1] / cpu[0]:.2f} "
               f"| {user[0]:.2f}, {user[1]:.2f}: {user[1] / user[0]:.2f} | {wall[0]:.2f} | {wall[1]:.2f} |\n")


def write_table(paths):
    text = ""
    for result in committed.read(paths):
        text += (f"{result['shape']}, {result['size']} points, k = {result['k']}, {result['format'].upper()}, {result['threads']} threads, medians of "
                 f"{result['repeat']}; {committed.where(result)}.\n\n{''.join(table(result['rows']))}\n")
    committed.write_table("binding", f"{text}Runs in {committed.names(paths)}.\n")


def main():
    options = arguments()
    if options.table:
        return write_table(options.table)
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    bench = Bench(options)
    result = committed.begun(shape=options.shape, size=options.size, k=options.k, format=options.format, threads=options.threads,
                             repeat=options.repeat, rows=[bench.row(task) for task in options.tasks])
    output = committed.file_of(result, "binding", options.output)
    committed.write(output, result)
    sys.stdout.writelines(table(result["rows"]))
    print(f"in {output}")


if __name__ == "__main__":
    main()
