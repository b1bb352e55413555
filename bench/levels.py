# SPDX-License-Identifier: MIT
"""Levels of detail: how evenly the points of each depth lie, and what making a COPC file costs, against copc_converter where it is installed.

Points of depth 0 to d are looked at where octants of depth d have deeper nodes: elsewhere the cloud is complete. p1 is the first percentile of the distances
to the nearest other point there. ideal is the distance at which a greedy maximal Poisson disc sample of the same cloud has as many points. hole is the largest distance
of a point of the cloud to the nearest point of the level. seam is p1 within half the ideal distance of the faces of octants, over p1 elsewhere."""
import argparse
import os
import pathlib
import subprocess
import sys

import committed
import processes
from processes import ROOT

sys.path.insert(0, str(ROOT / "tests/readers"))
GENERATED = ("terrain", "statue", "tls")


def arguments():
    parser = argparse.ArgumentParser(prog="script/bench levels", description=__doc__.split("\n")[0])
    parser.add_argument("--size", default="1.5M", help="points of the clouds whose levels are looked at (default 1.5M)")
    parser.add_argument("--cost", nargs="*", default=["5M", "20M"], help="points of the clouds that are converted and timed (default 5M 20M)")
    parser.add_argument("--memory", default="256M", help="budget of each conversion (default 256M)")
    parser.add_argument("--repeat", type=int, default=3, help="timed runs (default 3)")
    parser.add_argument("--data", type=pathlib.Path, default=pathlib.Path(os.environ.get("POINTSWEEP_DATA", ROOT / "../shared/data")), help="folder of real scans")
    parser.add_argument("--converter", default="copc_converter", help="the other program (crate copc_converter)")
    parser.add_argument("--work", type=pathlib.Path, default=ROOT / "build/bench", help="folder for clouds and outputs")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--save", type=pathlib.Path, help="where the result goes (default bench/results)")
    parser.add_argument("--table", type=pathlib.Path, nargs="+", help="make the tables of docs/performance.md from these results instead")
    return parser.parse_args()


def tool(options, *words):
    processes.run([options.build / "cli/pointsweep", *words, "--force", "--quiet"])


def laz(options, shape, size):
    """A generated cloud as LAZ; a volume has points everywhere."""
    path = options.work / f"levels-{shape}-{size}.laz"
    if path.exists():
        return path
    if shape != "volume":
        points = path.with_suffix(".ply")
        tool(options, "generate", shape, points, "-n", processes.points(size), "--seed", 1)
    else:
        import numpy as np

        points = path.with_suffix(".npy")
        np.save(points, np.random.default_rng(1).random((processes.points(size), 3)) * 100)
    # One scale for all axes: where they differ, copc_converter measures distances in steps and puts 40 times fewer points into its root.
    tool(options, "convert", points, path, "--scale", "0.00001" if shape == "statue" else "0.001")
    points.unlink()
    return path


def real_scans(options):
    """Returns the three largest real scans below 60 MB, each from another folder."""
    found = sorted((p for p in options.data.rglob("*") if p.suffix in (".laz", ".las") and "malformed" not in p.parts), key=lambda p: -p.stat().st_size)
    chosen = {}
    for path in found:
        if path.stat().st_size < 60e6 and len(chosen) < 3:
            chosen.setdefault(path.parent, path)
    return list(chosen.values())


def converted(options, program, source):
    """The COPC file that a program makes of a file."""
    target = options.work / f"levels-{program}.copc.laz"
    target.unlink(missing_ok=True)
    if program == "pointsweep":
        command = [options.build / "cli/pointsweep", "convert", source, target, "--memory", options.memory, "--temp-dir", options.work, "--ignore-crs", "--quiet"]
    else:
        command = [options.converter, source, target, "--temp-dir", options.work, "--progress", "plain"]
    return target, processes.run(command, said=options.work / "levels-said.txt")


def points_by_depth(path):
    """Coordinates and depth of all points, by laspy."""
    import laspy
    import numpy as np
    from copc_file import read_copc

    copc = read_copc(path)
    places, depths = [], []
    with laspy.CopcReader.open(str(path)) as reader:
        for depth in sorted({node.level for node in copc.nodes.values() if node.points > 0}):
            points = reader.query(level=depth)
            places.append(np.stack([np.asarray(points[axis]) for axis in "xyz"], axis=1))
            depths.append(np.full(len(points), depth))
    return copc, np.concatenate(places), np.concatenate(depths)


def octants(copc, places, depth):
    import numpy as np

    side = 2 * copc.half_size / 2**depth
    return np.floor((places - (copc.center - copc.half_size)) / side).astype(np.int64), side


def is_divided(copc, places, depth):
    """Returns for each point whether its octant of a depth has deeper nodes with points."""
    deeper = {tuple(number >> (node.level - depth) for number in node.at) for node in copc.nodes.values() if node.level > depth and node.points > 0}
    cells, _ = octants(copc, places, depth)
    import numpy as np

    known, inverse = np.unique(cells, axis=0, return_inverse=True)
    return np.array([tuple(map(int, cell)) in deeper for cell in known])[inverse.reshape(-1)]


def ideal_distance(options, cloud, count):
    """Returns the radius at which the tool's poisson stage, which shares no code with levels, keeps this many points."""
    import numpy as np

    points, kept = options.work / "levels-ideal.npy", options.work / "levels-kept.csv"
    np.save(points, cloud)
    low, high = 0.0, float(np.linalg.norm(cloud.max(0) - cloud.min(0)))
    for _ in range(14):
        middle = (low + high) / 2 if low > 0 else high / 16
        tool(options, "thin", points, kept, "--poisson", f"{middle:.9g}", "--keep", "x")
        found = sum(1 for _ in open(kept)) - 1
        low, high = (middle, high) if found > count else (low, middle)
        if abs(found - count) <= 0.002 * count:
            break
    return middle


def quality(options, path):
    """A row for each depth."""
    import numpy as np
    from scipy.spatial import cKDTree

    copc, places, depths = points_by_depth(path)
    rows = []
    for depth in range(depths.max() + 1):
        spacing = copc.spacing / 2**depth
        inside = is_divided(copc, places, depth)
        level = places[depths <= depth]
        looked_at = inside[depths <= depth]
        row = {"depth": depth, "points": int(len(level)), "looked_at": int(looked_at.sum()), "spacing": spacing}
        rows.append(row)
        if looked_at.sum() < 1000:
            continue
        tree = cKDTree(level)
        nearest = cKDTree(level[looked_at]).query(level[looked_at], k=2, workers=-1)[0][:, 1]
        ideal = ideal_distance(options, places[inside], int(looked_at.sum()))
        cells, side = octants(copc, level[looked_at], depth)
        within = (level[looked_at] - (copc.center - copc.half_size)) / side - cells
        near_face = (np.minimum(within, 1 - within) * side).min(1) < ideal / 2
        row.update(p1_ideal=float(np.percentile(nearest, 1) / ideal), cv=float(nearest.std() / nearest.mean()), hole=float(tree.query(places[inside], workers=-1)[0].max() / spacing),
                   seam=float(np.percentile(nearest[near_face], 1) / np.percentile(nearest[~near_face], 1)) if 200 < near_face.sum() < len(nearest) - 200 else None)
    return rows


def has_converter(options):
    try:
        return subprocess.run([options.converter, "--version"], capture_output=True).returncode == 0
    except OSError:
        print(f"script/bench levels: {options.converter} is not installed, so nothing is compared with it", file=sys.stderr)
        return False


def costs(options, programs):
    rows = []
    for size in options.cost:
        source = laz(options, "terrain", size)
        runs = {program: [] for program in programs}
        for _ in range(options.repeat):
            for program in programs:
                target, figures = converted(options, program, source)
                runs[program].append({**figures, "bytes": target.stat().st_size})
        rows.append({"cloud": f"terrain {size}", "runs": runs})
    return rows


def tables(result):
    yield "| cloud | program | depth | points | p1 / ideal | variation | hole / s_d | seam |\n|---|---|---|---|---|---|---|---|\n"
    for cloud in result["quality"]:
        for program, rows in cloud["programs"].items():
            for row in rows:
                if "p1_ideal" in row:
                    seam = "-" if row["seam"] is None else f"{row['seam']:.2f}"
                    yield f"| {cloud['cloud']} | {program} | {row['depth']} | {row['looked_at']:,} | {row['p1_ideal']:.2f} | {row['cv']:.2f} | {row['hole']:.2f} | {seam} |\n"
    yield "\n| cloud | program | CPU s | wall s | peak MB | MB of the file |\n|---|---|---|---|---|---|\n"
    for row in result["costs"]:
        for program, runs in row["runs"].items():
            median = lambda figure: committed.median(runs, figure)
            yield f"| {row['cloud']} | {program} | {median('cpu_seconds'):.1f} | {median('wall_seconds'):.1f} | {median('peak_rss_bytes') / 2**20:.0f} | {median('bytes') / 1e6:.0f} |\n"


def main():
    options = arguments()
    if options.table:
        text = "".join(f"{committed.where(result)}, `--memory {result['memory']}`, {committed.names([path])}.\n\n{''.join(tables(result))}\n"
                       for result, path in zip(committed.read(options.table), options.table))
        return committed.write_table("levels", text)
    options.work.mkdir(parents=True, exist_ok=True)
    options.work = options.work.resolve()
    programs = ["pointsweep"] + (["copc_converter"] if has_converter(options) else [])
    result = committed.begun(memory=options.memory, quality=[], costs=[])
    clouds = [(f"{shape} {options.size}", laz(options, shape, options.size)) for shape in (*GENERATED, "volume")]
    for name, source in clouds + [(path.stem, path) for path in real_scans(options)]:
        row = {"cloud": name, "programs": {}}
        for program in programs:
            path, _ = converted(options, program, source)
            row["programs"][program] = quality(options, path)
            print(name, program, *row["programs"][program], sep="\n  ", flush=True)
        result["quality"].append(row)
    result["costs"] = costs(options, programs)
    committed.write(committed.file_of(result, "levels", options.save), result)
    sys.stdout.writelines(tables(result))


if __name__ == "__main__":
    main()
