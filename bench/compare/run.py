# SPDX-License-Identifier: MIT
"""Normals of one cloud by pointsweep and by the tools people use: whole processes, file to file.

The cloud is a generated one, whose true normals are known, written without them. Every answer is compared with the true
normals, up to sign, before its time counts. Neighbourhoods are the same k nearest points for all tools that take k (Open3D
and PCL count the point itself, so they get k + 1); CloudCompare takes a radius, so it is compared with pointsweep --radius.
The formulas differ: pointsweep weights neighbours by distance (Equation 1), the others do not. A tool that is not installed
is left out, and the result says so."""
import argparse
import datetime
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
import processes  # noqa: E402
from compare.point_files import Rows, write_positions  # noqa: E402
from processes import ROOT, points  # noqa: E402

CHECKED_ROWS = 20000
LARGEST_MEDIAN_ANGLE = 5  # degrees from the true normal


def arguments():
    parser = argparse.ArgumentParser(prog="script/compare", description=__doc__.split("\n")[0])
    parser.add_argument("--shapes", nargs="+", default=["statue", "terrain"])
    parser.add_argument("--sizes", nargs="+", default=["5M"], help="points, e.g. 500k 5M")
    parser.add_argument("-k", type=int, default=16)
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--memory", default="256M", help="budget of the run of pointsweep in little memory")
    parser.add_argument("--only", nargs="+", default=[], help="beginnings of names of tools to run in addition to pointsweep")
    parser.add_argument("--python", type=pathlib.Path, default=ROOT / "build/compare/venv/bin/python", help="Python that has Open3D")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/compare")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--output", type=pathlib.Path, help="result file (default: bench/results/<date>-<commit>-compare.json)")
    return parser.parse_args()


def package_version(name):
    return processes.said("dpkg-query", "-W", "-f", "${Version}", name)


class Tool:
    """`command` takes input PLY, input PCD, output without extension, k and a radius with about k neighbours."""

    def __init__(self, name, neighborhood, command, suffix=".ply", there=True, version="", names=("nx", "ny", "nz"),
                 plain=None):
        self.name, self.neighborhood, self.command, self.suffix = name, neighborhood, command, suffix
        self.there, self.version, self.names = there, version, names
        self.plain = plain  # command from its output to an uncompressed one, not timed


def tools(options):
    ours = options.build / "cli/pointsweep"
    python, script = options.python, pathlib.Path(__file__).parent / "open3d_normals.py"
    open3d = processes.said(python, "-c", "import open3d; print(open3d.__version__)") if python.exists() else "unknown"
    pdal = processes.said("pdal", "--version") if shutil.which("pdal") else ""
    quiet = ["--force", "--quiet", "--temp-dir", options.work]
    pdal_options = ["--writers.ply.storage_mode=little endian", "--filters.normal.always_up=false"]
    return [
        Tool("pointsweep", "k", lambda ply, pcd, out, k, r: [ours, "normals", ply, f"{out}.ply", "-k", k, *quiet]),
        Tool(f"pointsweep --memory {options.memory}", "k",
             lambda ply, pcd, out, k, r: [ours, "normals", ply, f"{out}.ply", "-k", k, "--memory", options.memory, *quiet]),
        Tool("Open3D", "k", lambda ply, pcd, out, k, r: [python, script, ply, f"{out}.ply", k],
             there=open3d != "unknown", version=open3d),
        Tool("PDAL", "k", lambda ply, pcd, out, k, r: ["pdal", "translate", ply, f"{out}.ply", "normal", f"--filters.normal.knn={k}", *pdal_options],
             there=bool(pdal), version=pdal, names=("normalx", "normaly", "normalz")),
        Tool("PCL", "k", lambda ply, pcd, out, k, r: ["pcl_normal_estimation", pcd, f"{out}.pcd", "-k", k + 1], suffix=".pcd",
             there=bool(shutil.which("pcl_normal_estimation")), version=package_version("pcl-tools"), names=("normal_x", "normal_y", "normal_z"),
             plain=lambda packed, plain: ["pcl_convert_pcd_ascii_binary", packed, plain, 1]),
        Tool("pointsweep --radius", "radius",
             lambda ply, pcd, out, k, r: [ours, "normals", ply, f"{out}.ply", "--radius", f"{r:g}", *quiet]),
        Tool("CloudCompare", "radius",
             lambda ply, pcd, out, k, r: ["CloudCompare", "-SILENT", "-C_EXPORT_FMT", "PLY", "-PLY_EXPORT_FMT", "BINARY_LE", "-NO_TIMESTAMP",
                                          "-AUTO_SAVE", "OFF", "-O", ply, "-OCTREE_NORMALS", f"{r:g}", "-SAVE_CLOUDS", "FILE", f"{out}.ply"],
             there=bool(shutil.which("CloudCompare")), version=package_version("cloudcompare")),
    ]


def angles(true, answer, names):
    """Degrees between computed and true normals, up to sign, ascending, of rows spread over the file."""
    if answer.count != true.count:
        sys.exit(f"script/compare: an answer has {answer.count} points instead of {true.count}")
    lower = [name.lower() for name in answer.names]
    names = [answer.names[lower.index(name)] for name in names]
    found = []
    for i in range(0, true.count, max(1, true.count // CHECKED_ROWS)):
        for a, b in zip(true.values(i, "xyz"), answer.values(i, [answer.names[lower.index(c)] for c in "xyz"])):
            if abs(a - b) > 1e-4:
                sys.exit(f"script/compare: row {i} of an answer is another point")
        a, b = true.values(i, ("nx", "ny", "nz")), answer.values(i, names)
        length = math.sqrt(sum(v * v for v in b))
        dot = abs(sum(u * v for u, v in zip(a, b)))
        found.append(math.degrees(math.acos(min(1, dot / length))) if length > 0 else 90)
    return sorted(found)


def radius_for(cloud, k):
    """A radius within which the surface around a point holds k others on average, from the area the points cover."""
    done = subprocess.run([cloud.tool, "info", "--json", cloud.path], capture_output=True, text=True, check=True)
    spacing = json.loads(done.stdout)["files"][0]["spacing"]
    # Points at random on a surface of density d have a median nearest distance of sqrt(ln 2 / (pi d)).
    density = math.log(2) / (math.pi * spacing * spacing)
    return math.sqrt(k / (math.pi * density))


class Cloud:
    def __init__(self, options, shape, size):
        self.tool = options.build / "cli/pointsweep"
        self.true = processes.cloud(options, shape, size)
        self.path, self.pcd = self.true.with_stem(f"{shape}-{size}-positions"), self.true.with_name(f"{shape}-{size}-positions.pcd")
        if not self.path.exists() or not self.pcd.exists():
            write_positions(self.true, self.path, self.pcd)


def chosen(options):
    """The tools that run, and why the others do not."""
    run, left_out = [], {}
    for tool in tools(options):
        wanted = tool.name.startswith("pointsweep") or not options.only or any(tool.name.startswith(name) for name in options.only)
        if wanted and tool.there:
            run.append(tool)
        else:
            left_out[tool.name] = "not installed" if wanted else "not asked for"
    return run, left_out


def measure(options, run, shape, size):
    cloud = Cloud(options, shape, size)
    radius, true = radius_for(cloud, options.k), Rows(cloud.true)
    runs, checked = {tool.name: [] for tool in run}, {}
    for _ in range(options.repeat):
        for tool in run:
            output = options.work / f"output{tool.suffix}"
            output.unlink(missing_ok=True)
            command = tool.command(cloud.path, cloud.pcd, options.work / "output", options.k, radius)
            figures = processes.run(command, options.work / "said")
            if tool.plain:
                packed = output.rename(options.work / f"packed{tool.suffix}")
                processes.run(tool.plain(packed, output), options.work / "said")
                packed.unlink()
            found = angles(true, Rows(output), tool.names)
            output.unlink()
            if statistics.median(found) > LARGEST_MEDIAN_ANGLE:
                sys.exit(f"script/compare: {tool.name} is {statistics.median(found):.1f} degrees from the true normals; its answer does not count")
            checked[tool.name] = {"median": statistics.median(found), "p95": found[int(0.95 * len(found))]}
            runs[tool.name].append(figures)
    for tool in run:
        median = {figure: statistics.median(r[figure] for r in runs[tool.name]) for figure in runs[tool.name][0]}
        print(f"{shape} {size} {tool.name:<28}{median['wall_seconds']:>9.2f} s{median['cpu_seconds']:>9.2f} s CPU"
              f"{median['peak_rss_bytes'] / 1e6:>8.0f} MB   {checked[tool.name]['median']:.2f} degrees", flush=True)
        yield {"shape": shape, "points": points(size), "k": options.k, "radius": radius if tool.neighborhood == "radius" else None,
               "program": tool.name, "version": tool.version, "angle_degrees": checked[tool.name], "median": median, "runs": runs[tool.name]}


def main():
    options = arguments()
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    run, left_out = chosen(options)
    for name, reason in left_out.items():
        print(f"{name}: {reason}")
    rows = [row for size in options.sizes for shape in options.shapes for row in measure(options, run, shape, size)]
    today, commit = datetime.date.today().isoformat(), processes.commit()
    result = {"kind": "compare", "date": today, "commit": commit, "compiler": processes.compiler(options.build), "machine": processes.machine(),
              "left_out": left_out, "rows": rows}
    output = options.output or ROOT / f"bench/results/{today}-{commit}-compare.json"
    output.write_text(json.dumps(result, indent=1) + "\n")
    print(f"wrote {output}")


if __name__ == "__main__":
    main()
