# SPDX-License-Identifier: MIT
"""The Python package against pgeof, jakteristics, SciPy, scikit-learn, pynanoflann and Open3D: neighbours, normals and
features of arrays, and a NumPy operator against the same code on arrays in memory. Answers are compared before times
count; each call runs in a separate process."""
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

TASKS = ("neighbors", "normals", "features", "features_in_radius", "operator")
CONTENDERS = ("pointsweep", "numpy_in_memory", "scipy_ckdtree", "scikit_learn", "pynanoflann", "pgeof", "jakteristics", "open3d")


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench python", description=__doc__.split(":")[0])
    parser.add_argument("--shape", default="statue")
    parser.add_argument("--sizes", nargs="+", default=["1M"], help="points (default 1M)")
    parser.add_argument("--orders", nargs="+", choices=["random", "scan"], default=["random", "scan"])
    parser.add_argument("--tasks", nargs="+", choices=TASKS, default=TASKS)
    parser.add_argument("--contenders", nargs="+", choices=CONTENDERS, default=CONTENDERS)
    parser.add_argument("--cloud", type=pathlib.Path, help="a point file instead of generated points")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--table", nargs="+", type=pathlib.Path, metavar="RESULT", help="only write bench/log.md's table from these results")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>-python.json)")
    return parser.parse_args()


# In millimetres: pgeof adds 0.001 to the divisors of its features.
PREPARE = """
import sys, numpy as np, pointsweep as ps
shape, n, order, cloud, to = sys.argv[1:]
xyz = ps.open(cloud).run("decimate(1)")["xyz"] if cloud else ps.generate(shape, int(n))["xyz"] * 1000
if order == "scan":  # lines along x
    lines = np.floor((xyz[:, 1] - xyz[:, 1].min()) / np.ptp(xyz[:, 1]) * len(xyz) ** 0.5)
    xyz = xyz[np.lexsort((xyz[:, 0], lines))]
np.save(to, np.ascontiguousarray(xyz))
"""

# Distances agree to rounding; of the other answers the share of points whose difference is small is given, since definitions
# differ: pointsweep weights normals by distance, and jakteristics takes points within a radius.
COMPARE = """
import sys, numpy as np
task, a, b = sys.argv[1], np.load(sys.argv[2]).astype(float), np.load(sys.argv[3]).astype(float)
if task == "normals":
    length = np.linalg.norm(b, axis=1)
    print(np.mean(np.abs(np.einsum("nj,nj->n", a, b)) > np.cos(np.radians(10)) * np.where(length > 0, length, 1)))
else:
    print(np.mean(np.abs(a - b) <= {"neighbors": 1e-5 * np.abs(a).max(), "operator": 1e-6}.get(task, 1e-3)))
"""
LEAST_AGREEMENT = {"neighbors": 0.999999, "normals": 0.9, "features": 0.85, "features_in_radius": 0.85, "operator": 0.999}


class Bench:
    def __init__(self, options):
        self.options = options
        self.python = ROOT / "build/python-bench/bin/python"
        self.environment = {**os.environ, "PYTHONPATH": str(ROOT / "build/release/python"), "OMP_NUM_THREADS": str(options.threads)}

    def said(self, *words):
        done = subprocess.run([str(self.python), *map(str, words)], env=self.environment, capture_output=True, text=True, cwd=self.options.work)
        return done.stdout.strip() if done.returncode == 0 else None, done.stderr.strip().splitlines()[-1:]

    def rows(self, size, order):
        options = self.options
        cloud = options.work / f"python-{size}-{order}.npy"
        self.said("-c", PREPARE, options.shape, processes.points(size), order, options.cloud or "", cloud)
        for task in options.tasks:
            expected = None
            for contender in options.contenders:
                runs, answer = [], options.work / f"python-{contender}.npy"
                for _ in range(options.repeat):
                    text, complaint = self.said(ROOT / "bench/python/contenders.py", contender, task, cloud, answer, options.threads)
                    if text is None:
                        print(f"script/bench python: {contender} is left out of {task}: {' '.join(complaint)}", file=sys.stderr)
                    if text is None or text == "null":
                        break
                    runs.append(json.loads(text))
                if not runs:
                    continue
                if contender == "pointsweep":
                    expected = answer
                agreement = float(self.said("-c", COMPARE, task, expected, answer)[0]) if expected else None
                if agreement is not None and agreement < LEAST_AGREEMENT[task]:
                    sys.exit(f"script/bench python: {contender} agrees in {task} of {agreement:.2%} of the values only")
                yield {"size": size, "order": order, "task": task, "contender": contender, "agreement": agreement, "runs": runs}


def table(rows):
    yield "| points | order | task | library | wall s | CPU s | grew by MB | CPU over pointsweep | agrees |\n|---|---|---|---|---|---|---|---|---|\n"
    base = {(r["size"], r["order"], r["task"]): median(r["runs"], "cpu_seconds") for r in rows if r["contender"] == "pointsweep"}
    for r in rows:
        first = base.get((r["size"], r["order"], r["task"]))
        ratio = f"{median(r['runs'], 'cpu_seconds') / first:.2f}" if first else ""
        agrees = "" if r["agreement"] is None else f"{r['agreement']:.2%}"
        yield (f"| {r['size']} | {r['order']} | {r['task']} | {r['contender']} | {median(r['runs'], 'wall_seconds'):.2f} | {median(r['runs'], 'cpu_seconds'):.2f} "
               f"| {median(r['runs'], 'peak_bytes') / 2**20:.0f} | {ratio} | {agrees} |\n")


def write_table(paths):
    results = committed.read(paths)
    first = results[0]
    most = max(len(row["runs"]) for result in results for row in result["rows"])
    versions = ", ".join(f"{name} {first['versions'][name]}" for name in ("scipy", "scikit-learn", "pynanoflann", "pgeof", "jakteristics", "open3d-cpu")
                         if name in first["versions"])
    text = (f"{first['shape']}, k = {first['k']}, {first['threads']} threads, {'single runs' if most == 1 else f'medians of {most} runs'}; "
            f"{committed.where(first)}; {versions}.\n\n")
    text += "".join(table([row for result in results for row in result["rows"]]))
    committed.write_table("python", text + f"\nRuns in {committed.names(paths)}.\n")


def main():
    options = arguments()
    if options.table:
        return write_table(options.table)
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    bench = Bench(options)
    rows = [row for size in options.sizes for order in options.orders for row in bench.rows(size, order)]
    versions = subprocess.run([str(bench.python), "-m", "pip", "list", "--format=json", "--disable-pip-version-check"], capture_output=True, text=True)
    result = committed.begun(shape=options.cloud.name if options.cloud else options.shape, threads=options.threads, k=16,
                             versions={p["name"]: p["version"] for p in json.loads(versions.stdout)}, rows=rows)
    output = committed.file_of(result, "python", options.output)
    committed.write(output, result)
    sys.stdout.writelines(table(rows))
    print(f"in {output}")


if __name__ == "__main__":
    main()
