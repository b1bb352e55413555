#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""script/ground FOLDER: `ground` against the ground classes of airborne scans below FOLDER, as a table in Markdown.

For each scan: share of points (last returns without noise) that are classed otherwise than in the file, and Cohen's kappa, with the
options named; the same of the filter with the holes filled as in the paper, by springs over the whole raster (needs SciPy); and of the
cloth simulation filter (Zhang et al. 2016; package cloth-simulation-filter), if it is installed, as another method."""
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
METRES = {}
IN_FEET = {name: round(value / FEET, 3) for name, value in (("cell", 1.0), ("window", 18.0), ("threshold", 0.5), ("scalar", 1.25))}
FINE = {"cell": 0.5}
SCANS = [("IGN 0299_6802", "ign_las-digital-models/bridge/pointcloud/test_semis_2023_0299_6802_LA93_IGN69.laz", METRES),
         ("IGN 77050_627755", "ign_las-digital-models/test_data_77050_627755_LA93_IGN69.laz", FINE),
         ("IGN 77050_627760", "ign_las-digital-models/test_data_77050_627760_LA93_IGN69.laz", FINE),
         ("IGN 77055_627755", "ign_las-digital-models/test_data_77055_627755_LA93_IGN69.laz", FINE),
         ("IGN 77055_627760", "ign_las-digital-models/test_data_77055_627760_LA93_IGN69.laz", FINE),
         ("IGN dsmMarker", "ign_pdal-tools/las_with_origin_dsmMarker.laz", FINE),
         ("PDAL extra bytes", "pdal/laz/las_with_several_extra_byte_bloc.laz", METRES),
         ("Kentucky lock 4", "ky_lock4/ky_lock4_west.las", IN_FEET),
         ("lidR Megaplot", "lidR/Megaplot.laz", METRES),
         ("lidR Topography", "lidR/Topography.laz", METRES),
         ("lasR bcts_1", "lasR/bcts/bcts_1.laz", METRES),
         ("Autzen trim", "pdal/las/autzen_trim.las", IN_FEET)]


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
    """inpaint_nans, method 4: absent cells between springs of length 0 to their four neighbours. By conjugate gradients."""
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
    own_output = os.dup(1)  # the library prints what it does
    os.dup2(2, 1)
    cloth.do_filtering(ground, others, False)
    os.dup2(own_output, 1)
    found = np.full(len(points), False)
    found[rows[np.array(ground, int)]] = True
    return found


def cells_of(found, given):
    error, kappa = agreement(found, given)
    return f" {error:.2f} % | {kappa:.3f} |"


def row_of(name, path, options):
    cloud = laspy.read(path)
    points = np.column_stack([cloud.x, cloud.y, cloud.z])
    classes = np.asarray(cloud.classification)
    takes_part = np.asarray(cloud.return_number) >= np.asarray(cloud.number_of_returns)
    takes_part &= (classes != 7) & (classes != 18)
    given = classes[takes_part] == 2
    text = f"| {name} | {takes_part.sum():,} | {100 * given.mean():.0f} % | {', '.join(f'{k}={v}' for k, v in options.items())} |"
    text += cells_of(by_tool(path, options)[takes_part], given)
    for method in (as_in_the_paper, by_cloth):
        try:
            text += cells_of(method(points, takes_part, options)[takes_part], given)
        except ImportError:
            text += " | |"
    return text


def main():
    folder = pathlib.Path(sys.argv[1])
    print("| scan | points | ground in the file | options | error | kappa | error, springs | kappa, springs | error, cloth | kappa, cloth |")
    print("|---" * 10 + "|")
    for name, path, options in SCANS:
        if (folder / path).exists():
            print(row_of(name, folder / path, options), flush=True)


if __name__ == "__main__":
    main()
