# SPDX-License-Identifier: MIT
"""PTX and VTK text and raw float32 records, against numpy, which reads their numbers; what the lines mean is taken from the formats' descriptions."""
import numpy as np

import tool
from columns import assert_same
from ply_file import read_ply


def read_ptx_scan(lines, start, number):
    """Columns of the scan that starts in a line, and the line behind it. (x y z 1) times the four rows of the header; cells 0 0 0 are no points."""
    columns, rows = int(lines[start]), int(lines[start + 1])
    pose = np.loadtxt(lines[start + 6:start + 10])
    end = start + 10 + columns * rows
    cells = np.loadtxt(lines[start + 10:end], ndmin=2)
    place = np.arange(columns * rows)
    seen = (cells[:, :3] != 0).any(axis=1)
    position = np.c_[cells[:, :3], np.ones(len(cells))] @ pose
    scan = dict(zip("xyz", position.T[:3]), intensity=cells[:, 3], scan=np.full(len(cells), number), row=place % rows, column=place // rows)
    if cells.shape[1] == 7:
        scan.update(zip(("red", "green", "blue"), cells.T[4:]))
    return {name: values[seen] for name, values in scan.items()}, end


def read_ptx(path):
    lines, start, scans = path.read_text().split("\n"), 0, []
    while start < len(lines) and lines[start].strip():
        scan, start = read_ptx_scan(lines, start, len(scans))
        scans.append(scan)
    return {name: np.concatenate([scan[name] for scan in scans]) for name in scans[0]}


class PtxFilesAreReadAsNumpyReadsThem(tool.Files):
    """Coordinates within 4 units in the last place of the largest one, since numpy sums the products of a pose in its own order."""

    def test(self):
        self.each(tool.real_files(".ptx"), 4, self.check)

    def check(self, path):
        want = read_ptx(path)
        got = read_ply(tool.convert(path, self.folder / "out.ply"))
        self.assertEqual(sorted(got), sorted(want), "columns")
        tolerance = 4 * np.spacing(max(np.abs(want[axis]).max() for axis in "xyz"))
        assert_same(self, got, {name: want[name].astype(got[name].dtype) for name in got}, dict.fromkeys("xyz", tolerance))


class VtkFilesAreReadAsNumpyReadsThem(tool.Files):
    """Text with points and no attributes; no tolerance."""

    def test(self):
        self.each(tool.real_files(".vtk"), 3, self.check)

    def check(self, path):
        lines = path.read_text().split("\n")
        word, count, kind = lines[4].split()
        self.assertEqual((word, kind), ("POINTS", "float"))
        points = np.array(" ".join(lines[5:]).split()[:3 * int(count)], dtype=np.float32).reshape(-1, 3)
        assert_same(self, read_ply(tool.convert(path, self.folder / "out.ply")), dict(zip("xyz", points.T)))


class RawRecordsAreReadAsNumpyReadsThem(tool.Files):
    """Files of float32 x y z, with --format float32-xyz; no tolerance."""

    def test(self):
        self.each(tool.real_files(".bin"), 9, self.check)

    def check(self, path):
        points = np.fromfile(path, dtype=np.float32).reshape(-1, 3)
        got = read_ply(tool.convert(path, self.folder / "out.ply", "--format", "float32-xyz"))
        assert_same(self, got, dict(zip("xyz", points.T)))


if __name__ == "__main__":
    tool.main()
