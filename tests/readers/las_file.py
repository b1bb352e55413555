# SPDX-License-Identifier: MIT
"""LAS and LAZ files, read by laspy. LAZ is decoded by LASzip, since lazrs is the codec that pointsweep uses too."""
import re

import laspy
import numpy as np

SCAN_ANGLE_STEP = 0.006  # degrees, in point formats 6 to 10 (LAS 1.4 R15, table 18)


def read_las(path, backend=laspy.LazBackend.Laszip):
    return laspy.read(str(path), **{"laz_backend": backend} if path.suffix == ".laz" else {})


def name_in_ply(name):
    return re.sub(r"""[ ,;"']""", "_", name.strip())


def values_of(las, name):
    """A dimension as an array. laspy's views of bit fields and scaled integers name their own ways to one, fast ones."""
    view = las[name]
    for way in ("masked_array", "scaled_array"):
        if hasattr(view, way):
            return getattr(view, way)()
    return np.asarray(view)


def columns(las):
    """All attributes by the names that pointsweep documents (docs/las.md), as they stand in a PLY file: arrays as a column for each value."""
    found = {axis: values_of(las, axis) for axis in "xyz"}
    for dimension in las.point_format.standard_dimensions:
        if dimension.name in ("X", "Y", "Z"):
            continue
        values = values_of(las, dimension.name)
        if dimension.name == "scan_angle":
            values = values * SCAN_ANGLE_STEP
        found["scan_angle" if dimension.name == "scan_angle_rank" else dimension.name] = values
    for dimension in described_dimensions(las):
        values = values_of(las, dimension.name)
        name = name_in_ply(dimension.name)
        name += "_2" if name.lower() in found else ""
        if values.ndim == 1:
            found[name] = values
        else:
            found.update({f"{name}_{i}": values[:, i] for i in range(values.shape[1])})
    return found


def described_dimensions(las):
    """The extra bytes that a VLR describes; laspy calls bytes without a description ExtraBytes."""
    return [dimension for dimension in las.point_format.extra_dimensions if dimension.name != "ExtraBytes"]


def identity(header):
    """What a header says, without bounds, counts and offsets."""
    return {"version": str(header.version), "point format": header.point_format.id, "global encoding": header.global_encoding.value,
            "file source": header.file_source_id, "uuid": header.uuid, "system": header.system_identifier,
            "software": header.generating_software, "date": header.creation_date, "scales": list(header.scales),
            "offsets": list(header.offsets), "bytes behind the header": header.extra_header_bytes}


def records_of(vlrs):
    """User, number, description and content of (extended) VLRs, but those that make a file a COPC: outputs are none, as documented."""
    return [(vlr.user_id, vlr.record_id, vlr.description, vlr.record_data_bytes()) for vlr in vlrs or [] if vlr.user_id != "copc"]
