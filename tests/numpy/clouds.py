# SPDX-License-Identifier: MIT
"""Small clouds, their neighbours by brute force, and what the tool makes of them. Nothing here knows the code of pointsweep."""
import os
import pathlib
import subprocess
import tempfile
import unittest

import numpy as np
import plyfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
TOOL = os.environ.get("POINTSWEEP", ROOT / "build/release/cli/pointsweep")


def clouds(n=900):
    """Name and points: a noisy surface, volumes, planes, lines, duplicates, ties, large coordinates, outliers."""
    rng = np.random.default_rng(17)
    u = rng.random((n, 3))
    direction = rng.normal(size=(n, 3))
    direction /= np.linalg.norm(direction, axis=1, keepdims=True)
    yield "surface", direction * (1 + 0.1 * np.sin(5 * direction[:, :1])) + 0.002 * rng.normal(size=(n, 3))
    yield "volume", u
    yield "flat patch", u * [1, 1, 0] + [0, 0, 7]
    yield "upright patch", u * [1, 0, 1]
    yield "line", u * [1, 0, 0] + [0, 2, 3]
    yield "slanted line", u[:, :1] * [1, 2, 3]
    yield "one place", np.full((n, 3), 0.25)
    yield "grid full of ties", np.floor(9 * u)
    yield "duplicates", np.floor(30 * u) * [1, 0, 0]
    yield "national grid", np.round(4e3 * u) / 1e3 + [5e6, 4e6, 100]
    yield "outliers", np.where(rng.random((n, 1)) < 0.02, 1000 * (u - 0.5), u)
    yield "three points", u[:3]
    yield "one point", u[:1]


def nearest_first(distances2, points):
    """For each row of squared distances to these points their numbers, the nearest first; equal distances by x, y, z, row."""
    by_place = np.lexsort(points.T[::-1])
    return by_place[np.argsort(distances2[:, by_place], axis=1, kind="stable")]


def neighbors(points, k=None, radius=np.inf):
    """For each row the rows of its k nearest within the radius, the row itself left out; ties go by x, y, z, row."""
    dx, dy, dz = (points[:, None, a] - points[None, :, a] for a in range(3))
    d2 = (dx * dx + dy * dy) + dz * dz
    lists = []
    for i, order in enumerate(nearest_first(d2, points)):
        order = order[(order != i) & (d2[i][order] <= radius * radius)]
        lists.append(order[:k])
    return lists


def write_ply(path, points, **columns):
    dtype = [(axis, "f8") for axis in "xyz"] + [(name, values.dtype.str) for name, values in columns.items()]
    table = np.empty(len(points), dtype)
    for axis, values in zip("xyz", points.T):
        table[axis] = values
    for name, values in columns.items():
        table[name] = values
    plyfile.PlyData([plyfile.PlyElement.describe(table, "vertex")]).write(str(path))


def read_ply(path):
    vertices = plyfile.PlyData.read(str(path))["vertex"].data
    return {name: vertices[name] for name in vertices.dtype.names}


class Clouds(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="pointsweep_numpy_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def run_pipeline(self, points, pipeline, *options, **columns):
        """All columns of the output, in the order of the input."""
        source, target = self.folder / "in.ply", self.folder / "out.ply"
        write_ply(source, points, **columns)
        command = [TOOL, "run", source, target, "--pipeline", pipeline, "--threads", "2", "--quiet", "--force", *options]
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, f"{pipeline}: {done.stderr.strip()}")
        return read_ply(target)


def main():
    unittest.main(verbosity=2)
