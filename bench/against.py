# SPDX-License-Identifier: MIT
"""This checkout against an earlier commit: both built here, run in turn on the same clouds, compared as ratios."""
import argparse
import os
import pathlib
import statistics
import subprocess
import sys

import processes
from processes import ROOT


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench --against", description=__doc__)
    parser.add_argument("revision", help="commit, branch or tag to compare with")
    parser.add_argument("--shapes", nargs="+", default=["statue", "terrain", "tls"])
    parser.add_argument("--sizes", nargs="+", default=["5M"])
    parser.add_argument("--orders", nargs="+", choices=["random", "scan"], default=["random"])
    parser.add_argument("-k", nargs="+", type=int, default=[8])
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--verbs", nargs="+", default=["normals"], help="verbs to time, e.g. normals curvature splats")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--memory", help="budget of every run (default: the tool's own)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    return parser.parse_args()


def build_of(revision):
    """Builds the tool of a commit in a separate folder, which later runs use again. Returns the path of the tool."""
    commit = processes.said("git", "rev-parse", "--short", f"{revision}^{{commit}}")
    if commit == "unknown":
        sys.exit(f"script/bench --against: git knows no commit '{revision}'; name one of `git log`")
    source, build = ROOT / "build/against" / commit, ROOT / "build/against" / f"{commit}-build"
    for command in ([] if source.exists() else [["git", "worktree", "prune"], ["git", "worktree", "add", "--detach", source, commit]]) + [
            ["cmake", "-S", source, "-B", build, "-G", "Ninja", "-D", "CMAKE_BUILD_TYPE=Release", "-D", "POINTSWEEP_TESTS=OFF"],
            ["cmake", "--build", build, "--target", "pointsweep_cli"]]:
        if subprocess.run(command, cwd=ROOT, stdout=sys.stderr).returncode != 0:
            sys.exit(f"script/bench --against: cannot build {commit}: {' '.join(map(str, command))}")
    return commit, build / "cli/pointsweep"


def compare(options, tools, verb, shape, size, order, k):
    cloud = processes.cloud(options, shape, size, order)
    outputs = [options.work / f"output-{i}.ply" for i in range(2)]
    runs = [[], []]
    for _ in range(options.repeat):
        for i, tool in enumerate(tools):
            command = [tool, verb, cloud, outputs[i], "-k", k, "--threads", options.threads, "--temp-dir", options.work, "--force", "--quiet"]
            runs[i].append(processes.run(command + (["--memory", options.memory] if options.memory else [])))
    same = processes.same_bytes(*outputs)
    for output in outputs:
        output.unlink()
    ratios = {figure: [new[figure] / old[figure] for old, new in zip(*runs)] for figure in runs[0][0]}
    medians = {figure: statistics.median(values) for figure, values in ratios.items()}
    label = f"{verb} {shape} {size} {order} k={k}"
    print(f"{label:<36}{medians['cpu_seconds']:>8.3f}  {min(ratios['cpu_seconds']):.3f}..{max(ratios['cpu_seconds']):.3f}"
          f"{medians['wall_seconds']:>9.3f}{medians['peak_rss_bytes']:>9.3f}   {'same' if same else 'DIFFERENT'}")


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    commit, old = build_of(options.revision)
    print(f"Now over {commit}, medians of {options.repeat} runs in turn; below 1 is better now.")
    print(f"{'':<36}{'CPU':>8}  {'lowest..highest':<14}{'wall':>9}{'memory':>9}   bytes")
    for verb in options.verbs:
        for size in options.sizes:
            for shape in options.shapes:
                for order in options.orders:
                    for k in options.k:
                        compare(options, (old, options.build / "cli/pointsweep"), verb, shape, size, order, k)


if __name__ == "__main__":
    main()
