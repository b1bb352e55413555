# SPDX-License-Identifier: MIT
"""LAS files that pointsweep makes of clouds of other formats, against laspy."""
import numpy as np

import tool
from columns import assert_same, first_difference
from las_file import described_dimensions, read_las, values_of
from pcd_file import read_pcd
from ply_file import read_ply

# The field of LAS for an attribute (docs/formats.md, "Names"; docs/las.md).
FIELDS = {"nx": "NormalX", "ny": "NormalY", "nz": "NormalZ", "scalar_intensity": "intensity", "intensity": "intensity", "returnnumber": "return_number",
          "numberofreturns": "number_of_returns", "pointsourceid": "point_source_id", "gpstime": "gps_time", "userdata": "user_data",
          "scananglerank": "scan_angle", "classification": "classification", "red": "red", "green": "green", "blue": "blue", "curvature": "Curvature"}
HALF_A_STEP = {"scan_angle": 0.003}  # degrees


class LaspyReadsTheLasFilesOfOtherFormats(tool.Files):
    """Coordinates within half a step of the grid. Every other value stands exactly in its field or in extra bytes."""

    def test(self):
        self.each(tool.real_files(".ply", ".pcd", largest=1_000_000), 35, self.check)

    def check(self, path):
        want = {name: values for name, values in (read_ply(path) if path.suffix == ".ply" else read_pcd(path)).items()}
        finite = np.all([np.isfinite(want[axis]) for axis in axes(want)], axis=0)
        las = read_las(tool.convert(path, self.folder / "out.laz"))
        self.check_positions(las, {axis.lower(): want.pop(axis)[finite] for axis in axes(want)})
        for name, values in want.items():
            self.check_attribute(las, name, values[finite])

    def check_positions(self, las, want):
        steps = dict(zip("xyz", las.header.scales / 2 * (1 + 1e-6)))
        assert_same(self, {axis: values_of(las, axis) for axis in "xyz"}, want, steps)

    def check_attribute(self, las, name, want):
        """In the field of LAS, or where that cannot hold the values in extra bytes NAME_TYPE, or under its own name."""
        field = FIELDS.get(name.lower(), name)
        names = [f"{field}_{want.dtype.name}", name, field]
        present = [n for n in names if n in las.point_format.dimension_names]
        self.assertTrue(present, f"{name} is missing; there are {[d.name for d in described_dimensions(las)]}")
        values = values_of(las, present[0]) * (0.006 if present[0] == "scan_angle" else 1)
        if present[0] in ("red", "green", "blue") and want.dtype == np.uint8:
            want = want.astype(np.uint16) * 257  # full brightness is 65535 in LAS
        self.assertIsNone(first_difference(values, want, HALF_A_STEP.get(present[0], 0)), f"{name} in {present[0]}")


def axes(columns):
    return [name for name in columns if name in ("x", "y", "z", "X", "Y", "Z")]


if __name__ == "__main__":
    tool.main()
