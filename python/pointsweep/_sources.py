# SPDX-License-Identifier: MIT
"""Converts points of a caller, arrays or files, to inputs of the library. Arrays are copied only if a type must change."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from typing import Any, NamedTuple, TypeVar

import numpy as np

from . import _core
from ._adapters import are_points, arrays_by_name, crs_stated_by, from_dlpack
from ._blocks import spilled
from ._crs import Crs, crs_of, given_or_stated
from ._errors import UsageError, warn
from ._options import flag, listed, path, way_of_reading
from ._results import Arrays, Grid
from ._types import Files, FilesWithColumns, Path

_AXES = ("x", "y", "z")
_GROUPS = [("xyz", list(_AXES)), ("normal", ["nx", "ny", "nz"])]  # names of arrays, and the fields that each consists of
_LAS_BLOCK = 1 << 20  # points that laspy reads at once

_Files = TypeVar("_Files", bound=Files)


class Source(NamedTuple):
    """The points of a run."""

    inputs: list[Any]  #: paths as str, or pairs (names of components, (n, m) array)
    fields: list[str]  #: names of all components of the input
    groups: list[tuple[str, list[str]]]  #: names of arrays, and the components of the input that each consists of
    is_files: bool
    options: dict[str, Any]  #: options of the run and of opening files, and the coordinate system of arrays
    crs: Crs | None
    grid: Grid | None = None  #: steps and offsets of the coordinates in a LAS file that the points come from; None if not known
    names: list[str] = []  #: names of the outputs of these files in a folder of outputs; empty for arrays

    @property
    def divides(self) -> bool:
        """True if the run divides its output among files, which it names itself."""
        return bool(self.options["tile"] or self.options["split"])

    def require_clear(self, keep: Iterable[str]) -> None:
        """Raises UsageError if `keep` names 'xyz' and files have an attribute of this name beside x, y and z."""
        if self.is_files and "xyz" in keep and "xyz" in self.fields:
            raise UsageError(
                "keep: the files have an attribute 'xyz', which is what results call the positions; rename it first with "
                "run('set(w = xyz) | drop(xyz)', to=...), or keep 'x', 'y', 'z' and other attributes."
            )

    def kept_fields(self, keep: Iterable[str]) -> list[str]:
        """Returns the names in `keep` with the components of each array of the input in place of its name, for outputs in files."""
        there = {field.lower() for field in self.fields}
        groups = {name: parts for name, parts in self.groups if {part.lower() for part in parts} <= there}
        return [field for name in keep for field in groups.get(name, [name])]

    def array_names(self) -> list[str]:
        """Returns the names of all arrays that hold the points: groups whose components all exist, and other components."""
        fields = self.fields
        spelled = {**{field.lower(): field for field in reversed(fields)}, **{field: field for field in fields}}
        there = {name: [spelled[part] for part in parts] for name, parts in self.groups if set(parts) <= spelled.keys()}
        grouped = {part for parts in there.values() for part in parts}
        return [*there, *(field for field in fields if field not in grouped)]


def source_of(
    points: Any, attributes: Mapping[str, Any] | None, crs: Any, options: Mapping[str, Any], read: Set[str] = frozenset()
) -> Source:
    """Makes a source of `points` in any form that `pointsweep.run` accepts. `attributes`: more arrays, by name. `crs`:
    the system of the points. `options`: options of the run. `read`: names of arrays that operators of Python read; the
    components of such an array are called name_0, name_1, ..., since operators find no others. An iterator is spilled to a file."""
    _refuse_contents("points", points)
    if isinstance(points, (str, os.PathLike)) or _is_list_of_paths(points):
        points, crs = opened(Files, points, ignore_crs=options["ignore_crs"], crs=crs), None
    if isinstance(points, FilesWithColumns):
        raise UsageError("points: these files have columns, which this function does not read; write both to a file first.")
    if isinstance(points, Files):
        return _source_of_files(points, attributes, crs, options)
    if isinstance(points, (list, tuple)) and any(are_points(part) or isinstance(part, FilesWithColumns) for part in points[:2]):
        raise UsageError(
            f"points: a {type(points).__name__} of {len(points)} clouds is no cloud; join their arrays, give an iterator of them, "
            "iter([a, b]), or open files together, open([a, b])."
        )
    if hasattr(points, "chunk_iterator"):  # a reader of laspy
        points = points.chunk_iterator(_LAS_BLOCK)
    if isinstance(points, Iterator):
        stated = Arrays()
        stated.crs = crs_stated_by(points)
        columns = stated | spilled(points, _checked_arrays, options["temp_folder"] or None)
    else:
        columns = arrays_by_name(points)
    if attributes is not None and not isinstance(attributes, Mapping):
        raise UsageError(f"attributes: {type(attributes).__name__} is no dict; give one from names to arrays.")
    for name, values in (attributes or {}).items():
        if name in columns:
            raise UsageError(f"attributes: '{name}' is among the points, too; give it once.")
        columns[name] = values
    columns.crs = given_or_stated(crs, columns.crs)
    columns._components = {name: parts for name, parts in columns._components.items() if name not in read}
    return _source_of_arrays(columns, options)


def _source_of_files(files: Files, attributes: Mapping[str, Any] | None, crs: Any, options: Mapping[str, Any]) -> Source:
    if attributes:
        raise UsageError("attributes: is for points in arrays; add arrays to files with open(files).with_columns(name=array).")
    if crs is not None:
        raise UsageError("crs: these files are open; state their system in open(files, crs=...).")
    fields = [name for name, _, _ in files._known["attributes"]]
    ignores = {"ignore_crs": options["ignore_crs"] or files._options["ignore_crs"]}
    crs_of_files = files._known["crs"]
    stated = None if crs_of_files is None else Crs(crs_of_files)
    given = {**options, **files._options, **ignores}
    return Source(list(files.files), fields, _groups_beside(fields, _GROUPS), True, given, stated, _grid_of_file(files.files), files._names)


def _groups_beside(fields: list[str], groups: list[tuple[str, list[str]]]) -> list[tuple[str, list[str]]]:
    """Returns the groups, the last of each name, without those whose name is that of a field: the name means the field then."""
    return [(name, parts) for name, parts in dict(groups).items() if name not in fields]


def _grid_of_file(files: list[str]) -> Grid | None:
    """Returns the grid in the header of one local LAS or LAZ file; None for anything else."""
    if len(files) != 1 or not os.path.isfile(files[0]):
        return None
    with open(files[0], "rb") as file:
        header = file.read(179)
    if len(header) < 179 or not header.startswith(b"LASF"):
        return None
    numbers = struct.unpack_from("<6d", header, 131)
    return Grid(numbers[:3], numbers[3:])


def _refuse_contents(option: str, points: Any) -> None:
    """Raises UsageError for bytes and open files, whose contents this package does not read."""
    if isinstance(points, (bytes, bytearray)) or hasattr(points, "readline"):
        raise UsageError(f"{option}: {type(points).__name__} is no path; give the path of the file, or write its content to a file.")


def positions_of(option: str, points: Any, among: Source, ignore_crs: bool) -> np.ndarray:
    """Returns the (m, 3) positions of `points`, the arrays that the caller gives for `option`. Raises UsageError if their
    coordinate system differs from that of `among`, unless `ignore_crs`."""
    if isinstance(points, (str, os.PathLike, Files)) or _is_list_of_paths(points):
        raise UsageError(f"{option}: are positions in arrays; those of files are open(files).read(keep='xyz')['xyz'].")
    if isinstance(points, Iterator):
        raise UsageError(f"{option}: is an iterator; give the positions of one block after another, or all at once.")
    stated = crs_stated_by(points)
    if stated and among.crs and not ignore_crs and _core.differ(stated._known, among.crs._known):
        raise UsageError(
            f"{option}: are in {stated}, but the points in {among.crs}; transform one of them, or give ignore_crs=True."
        )
    arrays = _with_small_axes(arrays_by_name(points))
    if "xyz" in arrays:
        return _positions(arrays["xyz"], option)
    missing = [axis for axis in _AXES if axis not in arrays]
    if missing:
        raise UsageError(f"{option}: have no '{missing[0]}'; give an (m, 3) array, or 'x', 'y' and 'z'.")
    return np.column_stack([_column(axis, arrays[axis]) for axis in _AXES])


def opened(
    kind: type[_Files],
    files: Path | Sequence[Path],
    *,
    recursive: bool = False,
    format: str = "",
    columns: Sequence[str] | str | None = None,
    depth: int | None = None,
    resolution: float | None = None,
    ignore_crs: bool = False,
    crs: Any = None,
    replace_crs: bool = False,
) -> _Files:
    """Opens the point files that `files` means and reads their headers. The options are those of `pointsweep.open`."""
    _refuse_contents("open", files)
    named = listed(files)
    if not named:
        raise UsageError("open: name at least one point file.")
    for file in named:
        _refuse_contents("open", file)
        if not isinstance(file, (str, os.PathLike)):
            raise UsageError(f"open: {file!r} is not a path; arrays go to pointsweep.run at once.")
    format = way_of_reading(format, columns, depth, resolution)
    found, notices = _core.list_files([path("open", file) for file in named], flag("recursive", recursive), format)
    for notice in notices:
        warn(notice)
    if replace_crs and crs is None:
        raise UsageError("replace_crs: belongs to crs; name the system, or leave it out.")
    stated = None if crs is None else "none" if crs == "none" else crs_of(crs)
    options = {
        "ignore_crs": flag("ignore_crs", ignore_crs),
        "format": format,
        "crs": stated._known if isinstance(stated, Crs) else stated,
        "replace_crs": flag("replace_crs", replace_crs),
    }
    paths = [file for file, _ in found]
    return kind(paths, [name for _, name in found], options, _core.describe(paths, options))


def every_array(attributes: Iterable[str]) -> list[str]:
    """Returns the names of the arrays of all attributes of files: 'xyz' instead of x, y and z."""
    fields = list(attributes)
    positions = [axis if axis in fields else next((f for f in fields if f.lower() == axis), axis) for axis in _AXES]
    return ["xyz", *(name for name in fields if name not in positions)]


def _with_small_axes(arrays: dict[str, Any]) -> dict[str, Any]:
    """Returns the arrays with the names 'x', 'y' and 'z' for coordinates that are called 'X', 'Y' and 'Z'."""
    if "xyz" in arrays or set(_AXES) & arrays.keys():
        return arrays
    return {name.lower() if name in ("X", "Y", "Z") else name: values for name, values in arrays.items()}


def _is_list_of_paths(points: Any) -> bool:
    return (
        isinstance(points, (list, tuple)) and len(points) > 0 and all(isinstance(p, (str, os.PathLike)) for p in points)
    )


def _checked_arrays(block: Any) -> Arrays:
    """Returns the arrays of one block, whose columns must have the same length."""
    _refuse_contents("points", block)
    if isinstance(block, (Files, FilesWithColumns)):
        raise UsageError("points: a block is a cloud of files; open all files together, open([a, b]).")
    arrays = arrays_by_name(block)
    arrays.update({name: numbers(name, values) for name, values in arrays.items()})
    _source_of_arrays(arrays, {})
    return arrays


def _source_of_arrays(named: Arrays, options: Mapping[str, Any]) -> Source:
    arrays = _with_small_axes(named)
    columns: list[tuple[list[str], np.ndarray]] = []
    groups = list(_GROUPS)
    if "xyz" in arrays:
        columns.append((list(_AXES), _positions(arrays["xyz"])))
    else:
        missing = [axis for axis in _AXES if axis not in arrays]
        if missing:
            raise UsageError(
                f"the points have no '{missing[0]}'; name the coordinates 'xyz', an (n, 3) array, or 'x', 'y' and 'z'."
            )
        columns += [([axis], _column(axis, arrays[axis])) for axis in _AXES]
    for name, values in arrays.items():
        if not isinstance(name, str):
            raise UsageError(f"the points have an array called {name!r}; give it a name, which is a text.")
        if name == "xyz" or ("xyz" not in arrays and name in _AXES):
            continue
        column = _column(name, values)
        fields = _fields(name, column.shape[1], np.ndim(values) > 1)
        known = named._components.get(name, [])
        if len(known) == column.shape[1] and np.ndim(values) > 1 and not arrays.keys() & known:
            fields = list(known)
        columns.append((fields, column))
        if fields != [name]:
            groups.append((name, fields))
    _require_equal_lengths(columns)
    names = [field for fields, _ in columns for field in fields]
    _require_different_names(names)
    given = {**options, "format": "", "crs": None if named.crs is None else named.crs._known}
    return Source(columns, names, _groups_beside(names, groups), False, given, named.crs, named._grid)


def _fields(name: str, values: int, is_list: bool) -> list[str]:
    if name == "normal" and values == 3:
        return ["nx", "ny", "nz"]
    return [f"{name}_{v}" for v in range(values)] if is_list else [name]


def _require_equal_lengths(columns: Iterable[tuple[list[str], np.ndarray]]) -> None:
    lengths = {fields[0]: len(column) for fields, column in columns}
    first, n = next(iter(lengths.items()))
    for name, length in lengths.items():
        if length != n:
            raise UsageError(f"'{name}' has {length} rows, but '{first}' has {n}; give one row for each point.")


def _require_different_names(fields: list[str]) -> None:
    if "" in fields:
        raise UsageError("an array has no name; give each attribute one.")
    if "row" in fields:
        raise UsageError("'row' is what results call the numbers of input rows; leave it out, or give this attribute another name.")
    for field in fields:
        if fields.count(field) > 1:
            raise UsageError(f"two arrays have components called '{field}'; give one of them another name.")


def _positions(values: Any, name: str = "xyz") -> np.ndarray:
    xyz = numbers(name, values)
    if xyz.ndim == 2 and xyz.shape[1] == 3:
        return xyz
    hint = "; transpose it" if xyz.ndim == 2 and xyz.shape[0] == 3 else ""
    raise UsageError(f"{name}: has the shape {xyz.shape}, but needs (n, 3), a row for each point{hint}.")


def _column(name: str, values: Any) -> np.ndarray:
    column = numbers(name, values)
    if column.ndim == 1:
        return column[:, np.newaxis]
    if column.ndim == 2 and column.shape[1] > 0:
        return column
    raise UsageError(f"{name}: has the shape {column.shape}, but needs (n,) or (n, m), a row for each point.")


def numbers(name: str, values: Any) -> np.ndarray:
    """Returns `values` as an array of real numbers in the byte order of the machine; copies only if they are not one."""
    if np.ma.isMaskedArray(values) and np.ma.is_masked(values):
        raise UsageError(f"{name}: has masked values; fill them with NaN, or leave these rows out.")
    try:
        is_foreign = hasattr(values, "__dlpack__") and not hasattr(values, "__array_interface__")
        array = from_dlpack(name, values) if is_foreign else np.asarray(values)
    except UsageError:
        raise
    except (TypeError, ValueError) as error:
        raise UsageError(f"{name}: {type(values).__name__} cannot be read as an array: {error}.") from error
    kind, size = array.dtype.kind, array.dtype.itemsize
    if kind == "O":
        raise UsageError(f"{name}: is an array of objects, not of numbers; convert it, e.g. with .astype(float).")
    if kind == "f" and size == 2:
        return array.astype(np.float32)
    if kind not in "fiub" or size > 8:
        raise UsageError(f"{name}: has the type {array.dtype}; give integers, float32 or float64.")
    return array if array.dtype.isnative else array.astype(array.dtype.newbyteorder("="))
