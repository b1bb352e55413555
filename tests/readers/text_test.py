# SPDX-License-Identifier: MIT
"""Text files, against numpy: those that pointsweep reads, and those that it writes."""
import numpy as np

import tool
from columns import assert_same
from las_file import columns as las_columns, read_las
from ply_file import read_ply
from written import read_any

ROWS_BEFORE = {".pts": 1, "car_cloud400.csv": 1}  # the number of points, the names
NAMES = {3: "x y z", 4: "x y z intensity", 6: "x y z nx ny nz", 7: "x y z intensity red green blue"}  # docs/formats.md


def read_text(path):
    skipped = ROWS_BEFORE.get(path.name, ROWS_BEFORE.get(path.suffix, 0))
    lines = path.read_text().replace(",", " ").split("\n")[skipped:]
    rows = np.loadtxt(lines, ndmin=2)
    return dict(zip(NAMES[rows.shape[1]].split(), rows.T))


class TextFilesAreReadAsNumpyReadsThem(tool.Files):
    """No tolerance: the nearest double of every number."""

    def test(self):
        self.each(tool.real_files(".xyz", ".pwn", ".csv", ".pts", ".3d"), 9, self.check)

    def check(self, path):
        assert_same(self, read_ply(tool.convert(path, self.folder / "out.ply")), read_text(path))


class NumpyReadsTheTextFilesThatWeWrite(tool.Files):
    """Of LAS, LAZ and PLY files: in its own type, every value is the one of the input again; of a decimal grid the decimal, which
    is as near to the value as raw * scale + offset in double can be."""

    def test(self):
        self.each(tool.real_files(".las", ".laz", ".ply", largest=150_000)[::2], 35, self.check)

    def check(self, path):
        want = read_ply(path) if path.suffix == ".ply" else las_columns(read_las(path))
        for suffix in (".xyz", ".csv"):
            with self.subTest(written=suffix):
                written = tool.convert(path, self.folder / f"out{suffix}")
                got = read_any(written)
                self.assertEqual(list(got), list(want), "names")
                rounding = {name: np.abs(values) * 2**-51 + 1e-9 for name, values in want.items() if values.dtype == np.float64}
                assert_same(self, {name: values.astype(want[name].dtype) for name, values in got.items()}, want, rounding)


if __name__ == "__main__":
    tool.main()
