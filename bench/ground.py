#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""script/ground FOLDER: compares `ground` with the ground classes of all airborne scans below FOLDER, as a table in Markdown.

A scan is a LAS or LAZ file of 20,000 to 3 million points, 5 to 95 % of them of class 2, with coordinates in metres or feet. Of files with
equal numbers of points and bounds only the first is used. All runs have default options, with lengths converted to feet if needed. For each
scan: the share of points (last returns without noise) whose class differs from the file, and Cohen's kappa. The same figures are given for
the filter with holes filled as in the paper, by springs over the whole raster (needs SciPy), and for the cloth simulation filter (Zhang et
al. 2016; package cloth-simulation-filter) if it is installed. The last line compares the two ways of filling holes."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import laspy
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests/numpy"))
import ground_test as whole_raster  # noqa: E402

TOOL = os.environ.get("POINTSWEEP", ROOT / "build/release/cli/pointsweep")
LOCAL_FILL = whole_raster.fill
FEET = 0.3048
IN_FEET = {name: round(value / FEET, 3) for name, value in (("cell", 1.0), ("window", 18.0), ("threshold", 0.5), ("scalar", 1.25))}
IN_FEET_WITHOUT_SAYING_SO = ("ky_lock4_west.las",)  # Kentucky single zone, US survey feet
FEWEST, MOST = 20_000, 3_000_000
LEAST_SHARE, MOST_SHARE = 0.05, 0.95


def summary_of(path):
    made = subprocess.run([str(TOOL), "info", "--json", str(path)], capture_output=True, text=True)
    return json.loads(made.stdout)["files"][0] if made.returncode == 0 else None


def options_of(path, summary):
    """Returns the options for the unit of the file; None if the coordinates are degrees."""
    bounds, unit = summary["bounds"], (summary["crs"] or {}).get("length_unit") or ""
    if max(bounds["max"][a] - bounds["min"][a] for a in (0, 1)) < 1:
        return None
    is_in_feet = "ft" in unit or path.name in IN_FEET_WITHOUT_SAYING_SO
    return IN_FEET if is_in_feet else {}


def scans(folder):
    seen = set()
    for path in sorted(p for p in folder.rglob("*") if p.suffix in (".las", ".laz")):
        summary = summary_of(path)
        if summary is None or not FEWEST <= summary["points"] <= MOST:
            continue
        share = (summary.get("classes") or {}).get("2", 0) / summary["points"]
        options = options_of(path, summary)
        same = (summary["points"], json.dumps(summary["bounds"]))
        if LEAST_SHARE <= share <= MOST_SHARE and options is not None and same not in seen:
            seen.add(same)
            yield path, options


def agreement(found, given):
    """Total error in percent and kappa."""
    same = (found == given).mean()
    by_chance = found.mean() * given.mean() + (1 - found.mean()) * (1 - given.mean())
    return 100 * (1 - same), (same - by_chance) / (1 - by_chance)


def by_tool(path, options):
    text = ", ".join(f"{name}={value}" for name, value in options.items())
    with tempfile.TemporaryDirectory() as folder:
        target = pathlib.Path(folder) / "ground.las"
        subprocess.run([str(TOOL), "run", str(path), str(target), "--quiet", "--pipeline", f"ground({text})"], check=True)
        return np.asarray(laspy.read(target).classification) == 2


def springs(raster, reach):
    """Fills holes like inpaint_nans, method 4: absent cells are connected with their four neighbours by springs of length 0. Solved by
    conjugate gradients."""
    from scipy import sparse
    from scipy.sparse import linalg
    absent = np.isnan(raster)
    number = np.full(raster.shape, -1)
    number[absent] = np.arange(absent.sum())
    rows, columns, weights, right = [], [], [], np.zeros(absent.sum())
    for axis in (0, 1):
        for sign in (-1, 1):
            to, source = [slice(None)] * 2, [slice(None)] * 2
            to[axis], source[axis] = (slice(1, None), slice(None, -1)) if sign < 0 else (slice(None, -1), slice(1, None))
            own, other, value = number[tuple(to)], number[tuple(source)], raster[tuple(source)]
            here = own >= 0
            rows.append(own[here]), columns.append(own[here]), weights.append(np.ones(here.sum()))
            both = here & (other >= 0)
            rows.append(own[both]), columns.append(other[both]), weights.append(-np.ones(both.sum()))
            edge = here & (other < 0)
            np.add.at(right, own[edge], value[edge])
    matrix = sparse.csr_matrix((np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))))
    result = raster.copy()
    begin = LOCAL_FILL(raster, reach)[absent]
    begin[np.isnan(begin)] = np.nanmean(raster)
    diagonal = sparse.diags(1 / matrix.diagonal())
    result[absent] = linalg.cg(matrix, right, x0=begin, rtol=1e-7, maxiter=2000, M=diagonal)[0]
    return result


def as_in_the_paper(points, takes_part, options):
    whole_raster.fill = springs
    try:
        return whole_raster.smrf(points, takes_part, **options)
    finally:
        whole_raster.fill = LOCAL_FILL


def by_cloth(points, takes_part, options):
    import CSF
    cloth = CSF.CSF()
    cloth.params.bSloopSmooth = False
    cloth.params.cloth_resolution = options.get("cell", 1.0)
    cloth.params.class_threshold = options.get("threshold", 0.5)
    rows = np.flatnonzero(takes_part)
    cloth.setPointCloud(points[rows] - points[rows].mean(axis=0))
    ground, others = CSF.VecInt(), CSF.VecInt()
    own_output = os.dup(1)  # the library prints messages to standard output
    os.dup2(2, 1)
    cloth.do_filtering(ground, others, False)
    os.dup2(own_output, 1)
    found = np.full(len(points), False)
    found[rows[np.array(ground, int)]] = True
    return found


def row_of(name, path, options):
    """Returns the row of the table, and the kappas of the methods; None for a method whose package is missing."""
    cloud = laspy.read(path)
    points = np.column_stack([cloud.x, cloud.y, cloud.z])
    classes = np.asarray(cloud.classification)
    takes_part = np.asarray(cloud.return_number) >= np.asarray(cloud.number_of_returns)
    takes_part &= (classes != 7) & (classes != 18)
    given = classes[takes_part] == 2
    text = f"| {name} | {takes_part.sum():,} | {100 * given.mean():.0f} % | {'feet' if options else ''} |"
    kappas = []
    for method in (lambda *_: by_tool(path, options), as_in_the_paper, by_cloth):
        try:
            error, kappa = agreement(method(points, takes_part, options)[takes_part], given)
            text += f" {error:.2f} % | {kappa:.3f} |"
        except ImportError:
            kappa = None
            text += " | |"
        kappas.append(kappa)
    return text, kappas


def main():
    folder = pathlib.Path(sys.argv[1])
    print("| scan | points | ground in the file | unit | error | kappa | error, springs | kappa, springs | error, cloth | kappa, cloth |")
    print("|---" * 10 + "|")
    all_kappas = []
    for path, options in scans(folder):
        text, kappas = row_of(path.relative_to(folder), path, options)
        print(text, flush=True)
        all_kappas.append(kappas)
    own = [k[0] for k in all_kappas]
    print(f"\nKappa of {len(own)} scans: {min(own):.3f} to {max(own):.3f}, median {np.median(own):.3f}.", end=" ")
    beside_springs = [k[0] - k[1] for k in all_kappas if k[1] is not None]
    if beside_springs:
        print(f"Beside springs: {min(beside_springs):+.3f} to {max(beside_springs):+.3f}, median {np.median(beside_springs):+.3f}.")


if __name__ == "__main__":
    main()
