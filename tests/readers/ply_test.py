# SPDX-License-Identifier: MIT
"""PLY files, against plyfile. No tolerance: names, types and bits of all values."""
import tool
from columns import assert_same
from ply_file import read_ply


def types(columns):
    return [values.dtype.newbyteorder("=") for values in columns.values()]


class PlyFilesAreReadAsPlyfileReadsThem(tool.Files):
    def test(self):
        self.each(tool.real_files(".ply", largest=20_000_000), 20, self.check)

    def check(self, path):
        got, want = read_ply(tool.convert(path, self.folder / "out.ply")), read_ply(path)
        assert_same(self, got, want)
        self.assertEqual(types(got), types(want), "types")


if __name__ == "__main__":
    tool.main()
