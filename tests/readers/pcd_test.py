# SPDX-License-Identifier: MIT
"""PCD files, against pypcd4. No tolerance."""
import numpy as np

import tool
from columns import assert_same
from las_file import columns as las_columns, read_las
from pcd_file import read_pcd
from ply_file import read_ply


class PcdFilesAreReadAsPypcd4ReadsThem(tool.Files):
    def test(self):
        self.each(tool.real_files(".pcd"), 35, self.check)

    def check(self, path):
        assert_same(self, read_ply(tool.convert(path, self.folder / "out.ply")), read_pcd(path))


class Pypcd4ReadsThePcdFilesThatWeWrite(tool.Files):
    """Of LAS, LAZ and PCD files."""

    def test(self):
        self.each(tool.real_files(".las", ".laz", ".pcd", largest=200_000), 80, self.check)

    def check(self, path):
        want = read_pcd(path) if path.suffix == ".pcd" else las_columns(read_las(path))
        assert_same(self, read_pcd(tool.convert(path, self.folder / "out.pcd")), want)


if __name__ == "__main__":
    tool.main()
