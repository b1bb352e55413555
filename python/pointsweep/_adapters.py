# SPDX-License-Identifier: MIT
"""Point clouds of other libraries as arrays by name. Their types are recognised by their attributes; none of the libraries is imported."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

import numpy as np

from ._crs import Crs, crs_of, las_crs
from ._errors import UsageError
from ._results import ROW_NUMBERS, Arrays, Grid
from ._types import Files

_SCAN_ANGLE_STEP = 0.006  # degrees for each unit of the LAS field scan_angle, in point format 6 and later
_CPU_DEVICES = (1, 3, 11)  # device types of DLPack: plain memory, and memory pinned by CUDA or ROCm
#: Python attributes by which clouds and tables of other libraries are recognised: each has at least one of them
_OF_CLOUDS = ("chunk_iterator", "column_names", "columns", "geometry", "has_normals", "point", "point_format")


def are_points(value: Any) -> bool:
    """Returns whether the value is a cloud in memory or opened files, and not an option of a stage such as a name or three numbers."""
    if isinstance(value, (Mapping, Files, Iterator)) or any(hasattr(value, name) for name in _OF_CLOUDS):
        return True
    if isinstance(value, (list, tuple)):
        return any(isinstance(row, (list, tuple, np.ndarray)) for row in value)
    return getattr(value, "ndim", 0) >= 2 or bool(getattr(getattr(value, "dtype", None), "names", None))


def arrays_by_name(points: Any) -> Arrays:
    """Returns the arrays of a dict, a structured array, a table or a cloud of another library, with the coordinate system, the
    names of components and the grid that the points state; anything else becomes 'xyz'."""
    found = _named(points)
    result = Arrays(found)
    result.crs = crs_stated_by(points)
    if isinstance(points, Arrays):
        result._grid, result._components = points._grid, points._components
    else:
        result._grid = _las_grid(points)
    return result


def _named(points: Any) -> dict[str, Any]:
    if isinstance(points, Arrays) or _has_numbers_of_rows(points):
        # 'row' holds row numbers in the input of the earlier run, which mean nothing here
        return {name: values for name, values in _columns_of(points).items() if name != "row"}
    return _columns_of(points)


def _columns_of(points: Any) -> dict[str, Any]:
    if isinstance(points, Mapping):
        return dict(points)
    if _is_geometry(points):
        return _geometries(points)
    fields = getattr(getattr(points, "dtype", None), "names", None)
    if fields:
        return {name: points[name] for name in fields}
    if hasattr(points, "point_format") and hasattr(points, "x"):
        return _las_data(points)
    if hasattr(points, "has_normals") and hasattr(points, "points"):
        return _open3d_legacy(points)
    if "positions" in getattr(points, "point", ()):
        return _open3d_tensors(points)
    if hasattr(points, "__dask_graph__") and hasattr(points, "columns"):
        raise UsageError("points: a data frame of Dask has no values yet; give frame.compute(), or (p.compute() for p in frame.partitions).")
    if hasattr(points, "column_names") and hasattr(points, "column"):
        _require_different(points.column_names)
        return {name: _arrow_column(name, points.column(name)) for name in points.column_names}
    if hasattr(points, "columns") and hasattr(points, "__getitem__"):
        _require_different(points.columns)
        return {str(name): _table_column(name, points[name]) for name in points.columns}
    return {"xyz": points}


def crs_stated_by(points: Any) -> Crs | None:
    """Returns the coordinate system that a cloud of another library, or the result of a run, states; None without one."""
    if isinstance(points, Arrays):
        return points.crs
    header = getattr(getattr(points, "reader", points), "header", None)
    if hasattr(header, "vlrs"):
        return las_crs(header)
    return crs_of(points.crs) if _is_geometry(points) else None


def _require_different(columns: Iterable[Any]) -> None:
    """Raises UsageError if two columns of a table have the same name."""
    seen = set()
    for name in map(str, columns):
        if name in seen:
            raise UsageError(f"points: the table has two columns called '{name}'; rename one of them, or leave it out.")
        seen.add(name)


def _has_numbers_of_rows(points: Any) -> bool:
    """Returns whether the points are a table made of `Arrays`, whose column 'row' holds numbers of input rows."""
    stated = getattr(points, "attrs", None) or getattr(getattr(points, "schema", None), "metadata", None)
    return isinstance(stated, Mapping) and (ROW_NUMBERS in stated or ROW_NUMBERS.encode() in stated)


def _las_grid(points: Any) -> Grid | None:
    """Returns the grid of a laspy.LasData, a reader of laspy or a block of its points; None for other points."""
    header = getattr(getattr(points, "reader", points), "header", points)
    if not (hasattr(header, "scales") and hasattr(header, "offsets") and hasattr(header, "point_format")):
        return None
    return Grid(tuple(map(float, header.scales)), tuple(map(float, header.offsets)))  # type: ignore[arg-type]


def from_dlpack(name: str, values: Any) -> Any:
    """Converts an object with `__dlpack__` that is no NumPy array to an array. Raises UsageError if the CPU cannot read its memory."""
    device = values.__dlpack_device__()
    if int(getattr(device[0], "value", device[0])) not in _CPU_DEVICES:  # Open3D gives an enum in place of a number
        raise UsageError(f"{name}: is on another device, {device}; copy it to the CPU first.")
    try:
        return np.from_dlpack(values)
    except (BufferError, RuntimeError, TypeError, ValueError) as error:
        raise UsageError(f"{name}: {type(values).__name__} cannot be read through DLPack: {error}.") from error


def _las_data(las: Any) -> dict[str, Any]:
    """Returns the arrays of a laspy.LasData, or of a block of points of its readers, under the names that pointsweep
    gives the fields of LAS files."""
    arrays = {axis: np.asarray(getattr(las, axis)) for axis in "xyz"}
    for name in las.point_format.dimension_names:
        if name in ("X", "Y", "Z"):
            continue
        values = np.asarray(las[name])
        if name == "scan_angle":
            values = values * _SCAN_ANGLE_STEP
        arrays["scan_angle" if name == "scan_angle_rank" else name] = values
    return arrays


def _is_geometry(points: Any) -> bool:
    """Returns whether `points` is a GeoSeries or a GeoDataFrame of geopandas."""
    return hasattr(points, "geometry") and hasattr(points, "has_z") and hasattr(points, "crs")


def _geometries(frame: Any) -> dict[str, Any]:
    """Returns the columns of a GeoDataFrame as arrays. Adds 'xyz' from the geometry if no columns hold the coordinates."""
    geometry = frame.geometry
    names = [name for name in getattr(frame, "columns", ()) if name != geometry.name]
    arrays = {str(name): _table_column(name, frame[name]) for name in names}
    if "xyz" in arrays or {"x", "y", "z"} <= arrays.keys():
        return arrays
    if not ((geometry.geom_type == "Point") & geometry.has_z).all():
        raise UsageError("geometry: not all of it are points with a height; give them one, or columns x, y and z beside it.")
    return {"xyz": np.column_stack([geometry.x, geometry.y, geometry.z]), **arrays}


def _open3d_legacy(cloud: Any) -> dict[str, Any]:
    arrays = {"xyz": np.asarray(cloud.points)}
    if cloud.has_normals():
        arrays["normal"] = np.asarray(cloud.normals)
    if cloud.has_colors():
        arrays["colors"] = np.asarray(cloud.colors)
    return arrays


def _open3d_tensors(cloud: Any) -> dict[str, Any]:
    renamed = {"positions": "xyz", "normals": "normal"}
    arrays = {}
    for name in cloud.point:
        values = from_dlpack(name, cloud.point[name])
        is_column = values.ndim == 2 and values.shape[1] == 1
        arrays[renamed.get(name, name)] = values[:, 0] if is_column else values
    return arrays


def _table_column(name: Any, column: Any) -> Any:
    """Converts a column of a data frame to an array; missing values become NaN."""
    values = column.to_numpy()
    if values.dtype.kind != "O":
        return values
    try:
        return column.to_numpy(dtype=np.float64, na_value=np.nan)
    except (TypeError, ValueError):
        raise UsageError(
            f"{name}: is a column of {column.dtype}, not of numbers; leave it out, e.g. with .drop(columns=...)."
        ) from None


def _arrow_column(name: str, column: Any) -> Any:
    if hasattr(column, "combine_chunks"):
        column = column.combine_chunks()
    width = getattr(column.type, "list_size", None)
    if width is not None:
        return _arrow_column(name, column.flatten()).reshape(-1, width)
    values = column.to_numpy(zero_copy_only=False)
    if values.dtype.kind == "O":
        raise UsageError(f"{name}: is a column of {column.type}, not of numbers; leave it out, e.g. with .drop_columns().")
    return values
