# SPDX-License-Identifier: MIT
"""Timed processes, the clouds for them, and a description of the machine."""
import json
import os
import pathlib
import platform
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def points(text):
    factor = {"k": 10**3, "M": 10**6, "G": 10**9}.get(text[-1])
    return int(float(text[:-1]) * factor) if factor else int(text)


def run(command, said=None, before=None):
    """Returns the wall and CPU seconds, peak resident bytes and bytes read of one process. Its output goes to the file `said`, if given.
    `before` is called in the new process before the command."""
    command = [str(word) for word in command]
    launched = [sys.executable, "-I", "-S", str(ROOT / "bench/launch.py"), str(said or ""), *command]
    figures = json.loads(subprocess.run(launched, check=True, stdout=subprocess.PIPE, text=True, preexec_fn=before).stdout)
    if status := figures.pop("status"):
        sys.exit(f"script/bench: status {status} from: {' '.join(command)}")
    return figures


def cloud(options, shape, size, order="random", file_format="ply"):
    """The file of a generated cloud, made if it is not there: points in random order, or line after line as scanned."""
    path = options.work / f"{shape}-{size}.ply"
    if not path.exists():
        run([options.build / "cli/pointsweep", "generate", shape, path, "-n", points(size), "--seed", 1, "--quiet", "--force"])
    if file_format == "las":
        path = derived(path, path.with_suffix(".las"), options.build / "bench/las_from_ply")
    if order == "scan":
        path = derived(path, path.with_stem(path.stem + "-scan"), options.build / "bench/scan_order")
    return path


def derived(path, other, program):
    if not other.exists():
        run([program, path, other])
    return other


def header_bytes(path):
    """Bytes of the header of a PLY file, whose comments say how it was made; 0 for other formats."""
    if not str(path).endswith(".ply"):
        return 0
    with open(path, "rb") as file:
        head = file.read(1 << 20)
    return head.index(b"end_header\n") + 11


def same_bytes(a, b):
    """Returns whether two files hold the same bytes, ignoring PLY headers."""
    return subprocess.run(["cmp", "-s", f"--ignore-initial={header_bytes(a)}:{header_bytes(b)}", a, b]).returncode == 0


def machine():
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "unknown")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    return {"cpu": cpu, "cpus": len(os.sched_getaffinity(0)), "memory_bytes": memory, "system": platform.platform()}


def said(*command):
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    return done.stdout.strip().split("\n")[0] if done.returncode == 0 else "unknown"


def commit():
    return said("git", "rev-parse", "--short", "HEAD") + ("+" if said("git", "status", "--porcelain") else "")


def compiler(build):
    for line in (build / "CMakeCache.txt").read_text().splitlines():
        if line.startswith("CMAKE_CXX_COMPILER:"):
            return said(line.split("=", 1)[1], "--version")
    return "unknown"
