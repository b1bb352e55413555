# SPDX-License-Identifier: MIT
"""PCD files, read by pypcd4, and by numpy where that refuses them."""
import re

import numpy as np
import pypcd4

# Sound files that pypcd4 1.5.1 refuses: versions .5 and .6, and rows that end with a blank. Text, so numpy reads them.
REFUSED_BY_PYPCD4 = {"bun4.pcd", "bunny.pcd", "pcd_ascii.pcd", "min_cut_segmentation_tutorial.pcd"}

NUMBER_OF_VALUE = re.compile(r"__0*(\d+)$")  # pypcd4 calls the values of a field that has several NAME__0000, NAME__0001, ...


def read_pcd(path):
    """Columns as documented (docs/formats.md): packed colours taken apart, padding left out."""
    if path.name in REFUSED_BY_PYPCD4:
        return read_rows(path)
    cloud = pypcd4.PointCloud.from_path(path)
    found = {}
    for name in cloud.fields:
        if name in ("rgb", "rgba"):
            found.update(colors(cloud.pc_data[name], name))
        elif not name.startswith("#$%&"):  # pypcd4's name of padding, the field "_"
            found[NUMBER_OF_VALUE.sub(r"_\1", name)] = cloud.pc_data[name]
    return found


def colors(packed, name):
    """0xAARRGGBB in 4 bytes, whether the file calls them an integer or a float."""
    bits = np.ascontiguousarray(packed).view(np.uint32)
    places = {"red": 16, "green": 8, "blue": 0}
    if name == "rgba":
        places["alpha"] = 24
    return {channel: (bits >> place).astype(np.uint8) for channel, place in places.items()}


def read_rows(path):
    lines = path.read_text().split("\n")
    start = next(number for number, line in enumerate(lines) if line.startswith("DATA"))
    names = next(line.split()[1:] for line in lines if line.startswith("FIELDS"))
    names = [name for name in names if name != "_"]
    rows = np.loadtxt(lines[start + 1:], ndmin=2, dtype=np.float32, usecols=range(len(names)))
    return {name: rows[:, column] for column, name in enumerate(names)}
