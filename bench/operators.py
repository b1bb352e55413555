# SPDX-License-Identifier: MIT
"""Operators compared with other libraries that hold the cloud in memory, and with themselves in little memory.

Whole runs of pointsweep, from file to file, without a limit and with --memory, are compared with one call of the other library on arrays in
memory; its process has read them before, and its peak includes them. Answers are compared before times count."""
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

# Name; pipeline, in which {other} is a second cloud and {r} a radius; shape; libraries. Radii hold about 16 points of a statue of 1M
# points, and are scaled with the spacing for other numbers of points.
OPERATORS = [
    ("features", "knn(k=16) | features(names=[linearity,planarity,sphericity], eigenvalues=sqrt)", "statue", ["pgeof"]),
    ("sor", "knn(k=16) | sor(definition=open3d)", "statue", ["open3d"]),
    ("ror", "knn(k=8) | ror(radius={r}, min_neighbors=8)", "statue", ["open3d"]),
    ("lof", "knn(k=16) | lof", "statue", ["scikit_learn"]),
    ("unique", "unique", "statue", ["numpy"]),
    ("voxel", "voxel({r})", "statue", ["open3d"]),
    ("poisson", "poisson({r})", "statue", []),
    ("ground", "ground", "terrain", []),
    ("height", "height(k=1)", "ground", ["scipy"]),
    ("components", "knn(radius={r}) | components(distance={r})", "statue", ["scipy"]),
    ("dbscan", "knn(radius={r}) | dbscan(eps={r}, min_points=8)", "statue", ["scikit_learn"]),
    ("segments", "knn(k=8) | normals | segments(angle=5)", "statue", []),
    ("orient", "knn(k=8) | normals | orient", "statue", ["open3d"]),
    ("distance_to", "distance_to({other})", "statue", ["scipy", "open3d"]),
    ("m3c2", "knn(k=16) | normals | m3c2({other}, cylinder={d}, depth={d})", "statue", ["py4dgeo"]),
]


def arguments():
    names = [name for name, *_ in OPERATORS]
    parser = argparse.ArgumentParser(prog="script/bench operators", description=__doc__.split("\n")[0])
    parser.add_argument("--only", nargs="+", choices=names, default=names)
    parser.add_argument("--size", default="5M", help="points beside other libraries (default 5M; 0: none)")
    parser.add_argument("--large", default="20M", help="points within --memory and in memory (default 20M; 0: none)")
    parser.add_argument("--memory", default="256M")
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>-operators.json)")
    parser.add_argument("--table", nargs="+", type=pathlib.Path, metavar="RESULT", help="only write docs/performance.md's table from these results")
    return parser.parse_args()


class Bench:
    def __init__(self, options):
        self.options = options
        self.python = ROOT / "build/python-bench/bin/python"
        self.bounded = f"pointsweep, --memory {options.memory}"

    def tool(self, verb, *words):
        return processes.run([self.options.build / "cli/pointsweep", verb, *words, "--quiet", "--force"])

    def generated(self, shape, size, seed, *more):
        path = self.options.work / f"operators-{shape}-{size}-{seed}.ply"
        if not path.exists():
            self.tool("generate", shape, path, "-n", processes.points(size), "--double", "--seed", seed, *more)
        return path

    def clouds(self, shape, size):
        """Returns the cloud of an operator and the cloud with which it is compared."""
        if shape == "ground":  # terrain whose points have been classified by the operator ground
            terrain = self.generated("terrain", size, 1)
            path = terrain.with_stem(f"operators-ground-{size}")
            if not path.exists():
                self.tool("run", terrain, path, "--pipeline", "ground")
            return path, path
        noise = ("--noise", 0.0005)
        return self.generated(shape, size, 1, *noise), self.generated(shape, size, 2, *noise)

    def pipeline(self, text, other, size):
        r = round(0.004 * (1e6 / processes.points(size)) ** 0.5, 6)
        return text.format(other=f'"{other}"', r=r, d=2 * r)

    def own(self, text, cloud, output, *options):
        return self.tool("run", cloud, output, "--pipeline", text, "--threads", self.options.threads, "--no-provenance",
                         "--temp-dir", self.options.work, *options)

    def peer(self, library, operator, text, cloud, other, output):
        command = [self.python, ROOT / "bench/operators/peer.py", library, operator, text, cloud, other, output, self.options.threads]
        environment = {**os.environ, "OMP_NUM_THREADS": str(self.options.threads)}
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env=environment, cwd=self.options.work)
        if done.returncode != 0:
            print(f"script/bench operators: {library} is left out of {operator}: {' '.join(done.stderr.strip().splitlines()[-1:])}", file=sys.stderr)
            return None
        return json.loads(done.stdout.strip().splitlines()[-1])

    def beside_others(self, name, text, shape, libraries):
        size = self.options.size
        cloud, other = self.clouds(shape, size)
        text, output = self.pipeline(text, other, size), self.options.work / "operators-out.ply"
        runs = {"pointsweep": [self.own(text, cloud, output) for _ in range(self.options.repeat)],
                self.bounded: [self.own(text, cloud, output, "--memory", self.options.memory) for _ in range(self.options.repeat)]}
        agreement = {}
        for library in libraries:
            said = [self.peer(library, name, text, cloud, other, output) for _ in range(self.options.repeat)]
            if all(said):
                runs[library] = said
                agreement[library] = said[0]["agreement"]
                if not said[0]["agrees"]:
                    sys.exit(f"script/bench operators: {library} disagrees in {name}: {said[0]['agreement']}")
        return {"operator": name, "pipeline": text.replace(str(other), "OTHER"), "size": size, "runs": runs, "agreement": agreement}

    def within_memory(self, name, text, shape):
        size = self.options.large
        cloud, other = self.clouds(shape, size)
        text = self.pipeline(text, other, size)
        outputs = [self.options.work / f"operators-{way}.ply" for way in ("memory", "spilled")]
        runs = {"in_memory": [], "within_memory": []}
        for _ in range(self.options.repeat):
            runs["in_memory"].append(self.own(text, cloud, outputs[0]))
            runs["within_memory"].append(self.own(text, cloud, outputs[1], "--memory", self.options.memory))
        if not processes.same_bytes(*outputs):
            sys.exit(f"script/bench operators: {name} gives other bytes within {self.options.memory}")
        return {"operator": name, "pipeline": text.replace(str(other), "OTHER"), "size": size, "runs": runs}


def mega(runs):
    return f"{median(runs, 'peak_rss_bytes') / 2**20:.0f}"


def peers_table(rows):
    yield "| operator | library | wall s | CPU s | peak MB | CPU over pointsweep | answers |\n|---|---|---|---|---|---|---|\n"
    for row in rows:
        own = row["runs"]["pointsweep"]
        for library, runs in row["runs"].items():
            ratio = median(runs, "cpu_seconds") / median(own, "cpu_seconds")
            yield (f"| {row['operator']} | {library} | {median(runs, 'wall_seconds'):.1f} | {median(runs, 'cpu_seconds'):.1f} | {mega(runs)} "
                   f"| {'' if library == 'pointsweep' else f'{ratio:.2f}'} | {row['agreement'].get(library, '')} |\n")


def memory_table(rows, memory):
    yield f"| operator | CPU s in memory | within {memory} | ratio | peak MB in memory | within {memory} |\n|---|---|---|---|---|---|\n"
    for row in rows:
        free, held = row["runs"]["in_memory"], row["runs"]["within_memory"]
        a, b = median(free, "cpu_seconds"), median(held, "cpu_seconds")
        yield f"| {row['operator']} | {a:.1f} | {b:.1f} | {b / a:.2f} | {mega(free)} | {mega(held)} |\n"


def tables(result):
    if result["beside_others"]:
        yield f"{result['beside_others'][0]['size']} points, {result['threads']} threads:\n\n"
        yield from peers_table(result["beside_others"])
    if result["within_memory"]:
        yield f"\n{result['within_memory'][0]['size']} points, the same bytes in memory and within {result['memory']}:\n\n"
        yield from memory_table(result["within_memory"], result["memory"])


def write_table(paths):
    committed.write_table("operators", "".join(f"{committed.where(result)}, {committed.names([path])}. {''.join(tables(result))}\n"
                                               for path, result in zip(paths, committed.read(paths))))


def main():
    options = arguments()
    if options.table:
        return write_table(options.table)
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    bench = Bench(options)
    chosen = [row for row in OPERATORS if row[0] in options.only]
    result = committed.begun(threads=options.threads, memory=options.memory, beside_others=[], within_memory=[])
    output = committed.file_of(result, "operators", options.output)
    for name, text, shape, libraries in chosen:
        if options.size != "0":
            result["beside_others"].append(bench.beside_others(name, text, shape, libraries))
        if options.large != "0":
            result["within_memory"].append(bench.within_memory(name, text, shape))
        committed.write(output, result)
    sys.stdout.writelines(tables(result))
    print(f"in {output}")


if __name__ == "__main__":
    main()
