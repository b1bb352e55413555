# SPDX-License-Identifier: MIT
"""LAS files that laspy makes, with values of every size in every field."""
import datetime
import uuid

import laspy
import numpy as np

POINTS = 700
VERSIONS = {0: "1.1", 1: "1.2", 2: "1.2", 3: "1.2", 4: "1.3", 5: "1.3"}  # the others: 1.4
TYPES = ["uint8", "int8", "uint16", "int16", "uint32", "int32", "uint64", "int64", "float32", "float64"]


def las_of_point_format(point_format):
    header = laspy.LasHeader(point_format=point_format, version=VERSIONS.get(point_format, "1.4"))
    header.scales, header.offsets = [0.01, 0.001, 0.25], [500000.0, -0.125, 40.0]
    header.file_source_id, header.uuid = 513, uuid.UUID(int=0x0123456789ABCDEF0123456789ABCDEF)
    header.system_identifier, header.generating_software = "a scanner of tests", "laspy as an oracle"
    header.creation_date = datetime.date(2019, 2, 28)
    header.vlrs.append(laspy.VLR("tests", 7, "a record of bytes", bytes(range(256))))
    for extra in TYPES:
        header.add_extra_dim(laspy.ExtraBytesParams(f"plain {extra}", extra, "no scale"))
        if extra not in ("uint64", "int64"):
            header.add_extra_dim(laspy.ExtraBytesParams(f"scaled_{extra}", extra, "scale and offset", offsets=np.array([-7.5]), scales=np.array([0.125])))
    header.add_extra_dim(laspy.ExtraBytesParams("pair", "2uint16"))
    header.add_extra_dim(laspy.ExtraBytesParams("triple", "3float64"))
    las = laspy.LasData(header)
    las.points = laspy.ScaleAwarePointRecord.zeros(POINTS, header=header)
    fill(las.points.array, np.random.default_rng(point_format))
    if header.version.minor == 4:
        las.evlrs = laspy.vlrs.vlrlist.VLRList([laspy.VLR("tests", 9, "an extended record", b"behind the points" * 5000)])
    return las


def fill(records, random):
    """All bits of integers at random, but those of 64 bits, which PLY holds as double: these are below 2^53. Floats of all sizes, no NaN."""
    for name in records.dtype.names:
        values = records[name]
        if values.dtype.kind == "f":
            values[...] = random.normal(size=values.shape) * 10.0 ** random.integers(-20, 20, values.shape)
        elif values.dtype.itemsize == 8:
            values[...] = random.integers(0, 2**53, values.shape)
        else:
            limits = np.iinfo(values.dtype)
            values[...] = random.integers(limits.min, limits.max, values.shape, endpoint=True)
