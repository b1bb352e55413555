# SPDX-License-Identifier: MIT
"""Normals of generated clouds, file to file: pointsweep and nanoflann in turn, whole processes.

Every answer is compared with that of pointsweep in memory before its time counts. CPU seconds are user + system of the
process and its threads; files stay in the page cache between runs, for all programs alike."""
import argparse
import datetime
import json
import os
import pathlib
import platform
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench", description=__doc__.split("\n")[0])
    parser.add_argument("--shapes", nargs="+", default=["statue", "terrain", "tls"])
    parser.add_argument("--sizes", nargs="+", default=["1M", "5M", "20M"], help="points, e.g. 500k 20M")
    parser.add_argument("--repeat", type=int, default=3, help="timed runs of each program (default 3)")
    parser.add_argument("-k", type=int, default=8)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--memory", default="256M", help="budget of the out-of-core run (default 256M)")
    parser.add_argument("--only", nargs="+", help="names of contenders to run besides pointsweep in memory")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>.json)")
    return parser.parse_args()


def points(text):
    factor = {"k": 10**3, "M": 10**6, "G": 10**9}.get(text[-1])
    return int(float(text[:-1]) * factor) if factor else int(text)


def contenders(options):
    """Name -> command from an input and an output. The first is what the others are compared with."""
    sweep = [options.build / "cli/pointsweep", "normals"]
    sweep_end = ["-k", options.k, "--threads", options.threads, "--temp-dir", options.work, "--force", "--quiet"]
    flann_end = ["-k", options.k, "--threads", options.threads, "--order"]
    plain, native = options.build / "bench/nanoflann_normals", options.build / "bench/nanoflann_normals_native"
    all_of_them = {
        "pointsweep": lambda i, o: [*sweep, i, o, *sweep_end],
        f"pointsweep --memory {options.memory}": lambda i, o: [*sweep, i, o, *sweep_end, "--memory", options.memory],
        "nanoflann": lambda i, o: [plain, i, o, *flann_end, "file"],
        "nanoflann permuted": lambda i, o: [plain, i, o, *flann_end, "permuted"],
        "nanoflann permuted native": lambda i, o: [native, i, o, *flann_end, "permuted"],
    }
    return {n: c for n, c in all_of_them.items() if not options.only or n == "pointsweep" or n in options.only}


def run(command):
    """Wall and CPU seconds and peak resident bytes of one process."""
    command = [str(word) for word in command]
    begin = time.monotonic()
    pid = os.posix_spawn(command[0], command, os.environ)
    _, status, usage = os.wait4(pid, 0)
    wall = time.monotonic() - begin
    if status != 0:
        sys.exit(f"script/bench: status {os.waitstatus_to_exitcode(status)} from: {' '.join(command)}")
    return {"wall_seconds": wall, "cpu_seconds": usage.ru_utime + usage.ru_stime, "peak_rss_bytes": usage.ru_maxrss * 1024}


def compare(options, reference, output):
    done = subprocess.run([options.build / "bench/compare_normals", reference, output], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"script/bench: {output} differs from {reference}: {done.stdout}{done.stderr}")
    return json.loads(done.stdout)["share"]


def measure(options, shape, size):
    cloud = options.work / f"{shape}-{size}.ply"
    if not cloud.exists():
        made = subprocess.run([options.build / "cli/pointsweep", "generate", shape, cloud, "-n", str(points(size)), "--seed", "1",
                               "--quiet", "--force"])
        if made.returncode != 0:
            sys.exit(f"script/bench: cannot generate {cloud}")
    programs = contenders(options)
    runs = {name: [] for name in programs}
    differ = {}
    reference = options.work / "reference.ply"
    for _ in range(options.repeat):
        for name, command in programs.items():
            output = reference if name == "pointsweep" else options.work / "output.ply"
            output.unlink(missing_ok=True)
            figures = run(command(cloud, output))
            differ[name] = compare(options, reference, output)
            runs[name].append(figures)
    for output in (reference, options.work / "output.ply"):
        output.unlink(missing_ok=True)
    return [{"shape": shape, "points": points(size), "program": name, "rows_that_differ": differ[name], "runs": runs[name],
             "median": {figure: statistics.median(r[figure] for r in runs[name]) for figure in runs[name][0]}}
            for name in programs]


def machine():
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {"cpu": cpu, "cpus": len(os.sched_getaffinity(0)), "memory_bytes": memory, "system": platform.platform()}


def said(*command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip().split("\n")[0] if done.returncode == 0 else "unknown"


def compiler(build):
    for line in (build / "CMakeCache.txt").read_text().splitlines():
        if line.startswith("CMAKE_CXX_COMPILER:"):
            return said(line.split("=", 1)[1], "--version")
    return "unknown"


def print_table(rows):
    """Ratios are of medians, to the pointsweep run in memory."""
    print(f"{'cloud':<14}{'program':<28}{'wall s':>9}{'CPU s':>9}{'Mpoints/s':>11}{'peak MB':>9}{'CPU ratio':>11}{'differ':>9}")
    base = {}
    for row in rows:
        m = row["median"]
        base.setdefault((row["shape"], row["points"]), m["cpu_seconds"])
        print(f"{row['shape'] + ' ' + str(row['points'] / 1e6).rstrip('0').rstrip('.') + 'M':<14}{row['program']:<28}"
              f"{m['wall_seconds']:>9.2f}{m['cpu_seconds']:>9.2f}{row['points'] / 1e6 / m['wall_seconds']:>11.2f}"
              f"{m['peak_rss_bytes'] / 1e6:>9.0f}{m['cpu_seconds'] / base[row['shape'], row['points']]:>11.2f}"
              f"{row['rows_that_differ']:>9.1g}")


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    rows = []
    for size in options.sizes:
        for shape in options.shapes:
            print(f"script/bench: {shape} {size}", file=sys.stderr)
            rows += measure(options, shape, size)
    commit = said("git", "rev-parse", "--short", "HEAD") + ("+" if said("git", "status", "--porcelain") else "")
    today = datetime.date.today().isoformat()
    result = {"date": today, "commit": commit, "compiler": compiler(options.build), "machine": machine(), "k": options.k,
              "threads": options.threads, "rows": rows}
    output = options.output or ROOT / "bench/results" / f"{today}-{commit}.json"
    output.parent.mkdir(parents=True, exist_ok=True)
    output.write_text(json.dumps(result, indent=1) + "\n")
    print_table(rows)
    print(f"\n{output}")


if __name__ == "__main__":
    main()
