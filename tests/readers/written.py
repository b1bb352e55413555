# SPDX-License-Identifier: MIT
"""A point file that pointsweep wrote, whatever its format, read by others."""
import numpy as np

from las_file import columns as las_columns, read_las
from pcd_file import read_pcd
from ply_file import read_ply


def read_written_text(path):
    """Columns of double, under the names of the first line."""
    separator = "," if path.suffix == ".csv" else None
    with path.open() as file:
        names = file.readline().removeprefix("#").strip().split(separator)
    return dict(zip(names, np.loadtxt(path, ndmin=2, delimiter=separator, skiprows=1).T))


READERS = {".ply": read_ply, ".pcd": read_pcd, ".xyz": read_written_text, ".csv": read_written_text,
           ".las": lambda path: las_columns(read_las(path)), ".laz": lambda path: las_columns(read_las(path))}


def read_any(path):
    return READERS[path.suffix](path)
