# SPDX-License-Identifier: MIT
"""E57 files, against pye57, which is libE57Format."""
import numpy as np
import pye57

import tool
from columns import assert_same
from ply_file import read_ply
from written import read_any

NAMES = {"cartesianX": "x", "cartesianY": "y", "cartesianZ": "z", "colorRed": "red", "colorGreen": "green", "colorBlue": "blue",
         "returnIndex": "return_index", "returnCount": "return_count", "rowIndex": "row", "columnIndex": "column",
         "cartesianInvalidState": "invalid_state", "nor:normalX": "nx", "nor:normalY": "ny", "nor:normalZ": "nz",
         "las:pointSourceId": "pointSourceId"}
# pye57 reads the fields of this table, in these types; it lacks those that are added here, and 16 bits of a colour.
pye57.e57.SUPPORTED_POINT_FIELDS.update({"returnIndex": "B", "returnCount": "B", "nor:normalX": "f", "nor:normalY": "f", "nor:normalZ": "f",
                                         "las:pointSourceId": "H", "colorRed": "H", "colorGreen": "H", "colorBlue": "H"})


def read_scan(file, index):
    """Columns of one scan in the coordinates of the file; points that it calls invalid have NaN coordinates."""
    header = file.get_header(index)
    columns = {NAMES.get(name, name): values for name, values in file.read_scan_raw(index).items()}
    positions = np.array([columns[axis] for axis in "xyz"])
    if header.has_pose():
        positions = header.rotation_matrix @ positions + header.translation[:, None]
    if "invalid_state" in columns:
        positions[:, columns["invalid_state"] != 0] = np.nan
    columns.update(zip("xyz", positions), scan=np.full(len(positions[0]), index))
    return columns


def rounding(file, positions):
    """What two orders of the sums of a pose may differ by: 8 units in the last place of the largest number in them; 0 without poses."""
    headers = [file.get_header(index) for index in range(file.scan_count)]
    posed = [header for header in headers if header.has_pose()]
    size = max([np.abs(header.translation).max() for header in posed], default=0) + np.nanmax(np.abs(positions))
    return 8 * np.finfo(float).eps * size if posed else 0.0


def merged(scans):
    """One behind the other; an attribute that a scan lacks is 0 there."""
    names = dict.fromkeys(name for scan in scans for name in scan)
    return {name: np.concatenate([scan.get(name, np.zeros(len(scan["x"]))) for scan in scans]) for name in names}


class E57FilesAreReadAsPye57ReadsThem(tool.Files):
    def test(self):
        files = [path for path in tool.real_files(".e57") if pye57.E57(str(path)).scan_count > 0]
        self.each(files, 12, self.check)

    def check(self, path):
        file = pye57.E57(str(path))
        want = merged([read_scan(file, index) for index in range(file.scan_count)])
        got = read_ply(tool.convert(path, self.folder / "out.ply"))
        self.assertEqual(sorted(got), sorted(want), "columns")
        tolerance = rounding(file, [want[axis] for axis in "xyz"])
        assert_same(self, got, {name: want[name] for name in got}, dict.fromkeys("xyz", tolerance))


# What others call the attributes of the files written here, with the types of pye57's table.
WRITTEN = {"nx": "nor:normalX", "ny": "nor:normalY", "nz": "nor:normalZ", "red": "colorRed", "green": "colorGreen", "blue": "colorBlue",
           "x": "cartesianX", "y": "cartesianY", "z": "cartesianZ", "intensity": "intensity", "row": "rowIndex", "column": "columnIndex",
           "return_index": "returnIndex", "return_count": "returnCount", "time_stamp": "timeStamp", "scalar_intensity": "intensity",
           "normal_x": "nor:normalX", "normal_y": "nor:normalY", "normal_z": "nor:normalZ"}
POSITIONS = "cartesianX", "cartesianY", "cartesianZ"


def register(names, columns):
    """Names that pye57 is to read, in the types of these columns."""
    codes = {np.dtype("f4"): "f", np.dtype("f8"): "d"}
    for name, column in zip(names, columns):
        pye57.e57.SUPPORTED_POINT_FIELDS[name] = codes.get(column.dtype, column.dtype.char if column.dtype.itemsize < 4 else "q")


class E57FilesThatAreWrittenAreReadByPye57(tool.Files):
    """Every attribute of the E57 files made of real files of four formats, read by pye57, against the PLY files made of them, read by
    plyfile. Other tests compare these PLY files with the real files as others read them."""

    def test(self):
        files = tool.real_files(".las", ".laz", ".ply", ".pcd", largest=500_000)
        self.each(files, 60, self.check)

    def check(self, path):
        want = read_any(tool.convert(path, self.folder / "out.ply"))  # which other tests compare with the file
        made = tool.convert(path, self.folder / "out.e57")
        file = pye57.E57(str(made))
        want = {WRITTEN.get(name.lower(), f"ps:{name}"): column for name, column in want.items()}
        finite = np.isfinite([want[axis] for axis in POSITIONS]).all(axis=0)
        self.assertEqual((file.scan_count, file.get_header(0).point_count), (1, len(finite)))
        got = self.columns(made, want | {"cartesianInvalidState": finite.astype("u1")})
        for stored, column in want.items():
            with self.subTest(attribute=stored):
                keep = finite if stored in POSITIONS else slice(None)
                self.assertTrue(np.array_equal(got[stored][keep], column[keep], equal_nan=column.dtype.kind == "f"), stored)
        self.assertTrue(np.array_equal(got["cartesianInvalidState"] != 0, ~finite), "invalid points")

    @staticmethod
    def columns(path, like):
        """The attributes of a file that `like` names, in the types that they have there."""
        register(like.keys(), like.values())
        file = pye57.E57(str(path))
        vector = pye57.libe57.VectorSourceDestBuffer()
        columns = {}
        for name in like:
            columns[name], buffer = file.make_buffer(name, file.get_header(0).point_count)
            vector.append(buffer)
        file.get_header(0).points.reader(vector).read()
        return columns


if __name__ == "__main__":
    tool.main()
