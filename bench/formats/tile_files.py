# SPDX-License-Identifier: MIT
"""tile_files.py FOLDER TILES POINTS: tiles/tile00.laz, ... in a row along x, each of POINTS points in random order, and random.las of all their points in random order.

Hilly ground with a few millimetres of noise, point format 6, a grid of millimetres. Runs in the environment of script/python-env."""
import pathlib
import sys

import laspy
import numpy as np

WIDTH = 1000.0  # width of a tile, in metres


def header():
    made = laspy.LasHeader(point_format=6, version="1.4")
    made.scales, made.offsets = np.full(3, 0.001), np.zeros(3)
    return made


def ground(tile, points):
    random = np.random.default_rng(tile)
    x, y = WIDTH * (tile + random.random(points)), WIDTH * random.random(points)
    z = 40 * np.sin(x / 170) * np.cos(y / 130) + 4 * np.sin(x / 11 + y / 17) + random.normal(0, 0.005, points)
    las = laspy.LasData(header())
    las.xyz = np.stack([x, y, z], axis=1)
    las.intensity = random.gamma(4, 200, points).astype(np.uint16)
    las.classification = np.full(points, 2, np.uint8)
    las.gps_time = np.arange(points) * 2e-6
    return las


def main():
    folder, tiles, points = pathlib.Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
    (folder / "tiles").mkdir(parents=True, exist_ok=True)
    records = []
    for tile in range(tiles):
        las = ground(tile, points)
        las.write(str(folder / f"tiles/tile{tile:02}.laz"), laz_backend=laspy.LazBackend.LazrsParallel)
        records.append(las.points.array)
    everything = laspy.LasData(header())
    everything.points = laspy.ScaleAwarePointRecord(np.random.default_rng(99).permutation(np.concatenate(records)), header().point_format,
                                                    header().scales, header().offsets)
    unfinished = folder / "unfinished.las"
    everything.write(str(unfinished))
    unfinished.rename(folder / "random.las")


if __name__ == "__main__":
    main()
