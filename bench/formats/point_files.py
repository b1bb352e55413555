# SPDX-License-Identifier: MIT
"""point_files.py CLOUD.ply FOLDER: the points of a generated cloud as LAS, LAZ, PCD, E57 and PTX, beside it, by libraries of others.

The LAS file has point format 6 with the attributes of an airborne scan: intensities, returns, classes, angles, strips, and times
that rise with the rows. Runs in the environment of script/python-env. Files that are there are kept."""
import pathlib
import sys

import laspy
import numpy as np
import plyfile
import pye57
import pypcd4


def las_of(positions):
    rows, random = len(positions), np.random.default_rng(1)
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.offsets = np.floor(positions.min(axis=0))
    spacing = np.ptp(positions, axis=0).max() / np.sqrt(rows)
    header.scales = np.full(3, 10.0 ** np.floor(np.log10(spacing / 300)))  # as bench/normals/las_from_ply
    las = laspy.LasData(header)
    las.xyz = positions
    las.intensity = random.gamma(4, 200, rows).astype(np.uint16)
    las.number_of_returns = random.choice([1, 2, 3], rows, p=[0.7, 0.2, 0.1])
    las.return_number = np.minimum(las.number_of_returns, random.integers(1, 4, rows))
    las.classification = random.choice([2, 3, 5, 6], rows, p=[0.6, 0.1, 0.2, 0.1])
    las.scan_angle = (2500 * np.sin(np.arange(rows) / 700)).astype(np.int16)
    las.point_source_id = 1 + np.arange(rows) * 8 // max(rows, 1)
    las.gps_time = 3e8 + np.cumsum(random.exponential(2e-6, rows))
    return las


def write_e57(path, positions):
    with pye57.E57(str(path), mode="w") as file:
        file.write_scan_raw(dict(zip(("cartesianX", "cartesianY", "cartesianZ"), positions.T)))


def write_ptx(path, positions):
    with open(path, "w") as file:
        file.write(f"{len(positions)}\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n")
        for x, y, z in positions.tolist():
            file.write(f"{x!r} {y!r} {z!r} 0.5\n")


def main():
    cloud, folder = map(pathlib.Path, sys.argv[1:])
    vertices = plyfile.PlyData.read(str(cloud))["vertex"].data
    positions = np.stack([vertices[axis].astype(float) for axis in "xyz"], axis=1)
    writers = {
        ".las": lambda path: las_of(positions).write(str(path)),
        ".laz": lambda path: las_of(positions).write(str(path), laz_backend=laspy.LazBackend.LazrsParallel),
        ".pcd": lambda path: pypcd4.PointCloud.from_xyz_points(positions.astype(np.float32)).save(path),
        ".e57": lambda path: write_e57(path, positions),
        ".ptx": lambda path: write_ptx(path, positions),
    }
    for suffix, write in writers.items():
        path = folder / (cloud.stem + suffix)
        if not path.exists():
            unfinished = path.with_stem("unfinished")
            write(unfinished)
            unfinished.rename(path)


if __name__ == "__main__":
    main()
