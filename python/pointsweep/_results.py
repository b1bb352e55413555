# SPDX-License-Identifier: MIT
"""The results of runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ._crs import Crs
from ._errors import UsageError
from ._tables import html_table

if TYPE_CHECKING:
    import geopandas
    import pandas
    import pyarrow


#: key in the metadata of tables whose column 'row' holds numbers of input rows
ROW_NUMBERS = "pointsweep.row"
_MEANING_OF_ROW = "numbers of input rows"


class Grid(NamedTuple):
    """The grid of the coordinates in LAS files: coordinates are ``offset + integer * scale``."""

    scale: tuple[float, float, float]
    offset: tuple[float, float, float]


class Neighbors(NamedTuple):
    """The k nearest neighbours of every point, the point itself excluded, nearest first.

    A point may have fewer than k if a radius is given or the cloud has no more points; it has none if its coordinates
    are NaN or infinite. Unused places hold the largest value of their type, which is no row, so that ``xyz[indices]``
    raises an IndexError. ``mask`` is True for used places.
    """

    indices: np.ndarray  #: (n, k) rows, uint32, or uint64 from 2**32 - 1 points on; missing: the largest value
    distances: np.ndarray  #: (n, k) float64; missing: NaN

    @property
    def mask(self) -> np.ndarray:
        """(n, k) bool: True where there is a neighbour."""
        return ~np.isnan(self.distances)

    def of(self, values: Any) -> np.ndarray:
        """Returns an attribute of the neighbours, (n, k) or (n, k, m), from `values`, its array for all points. Unused places
        hold NaN, or 0 for integers. ``neighbors.of(xyz) - xyz[:, None]`` are the vectors from points to neighbours."""
        known = np.asarray(values)
        mask = self.mask
        found = known[np.where(mask, self.indices, 0)]
        found[~mask] = np.nan if known.dtype.kind == "f" else 0
        return found


class RadiusNeighbors(NamedTuple):
    """The neighbours of every point within a radius, nearest first. The neighbours of point i are at
    ``offsets[i]:offsets[i + 1]``."""

    offsets: np.ndarray  #: (n + 1,) int64
    indices: np.ndarray  #: rows, uint32, or uint64 from 2**32 - 1 points on
    distances: np.ndarray  #: float64


class Report:
    """The statistics of a run."""

    def __init__(self, statistics: str, to: str | None = None) -> None:
        import json

        #: everything the library counts and measures, as `pointsweep run --stats` writes it
        self.statistics: dict[str, Any] = json.loads(statistics)
        #: the file or folder that was written; None: the run returned arrays
        self.to = to

    @property
    def points(self) -> int:
        """The number of points in the input."""
        return int(self.statistics["points"])

    @property
    def points_written(self) -> int:
        """The number of points in the output."""
        return int(self.statistics["points_written"])

    @property
    def seconds(self) -> float:
        """Wall time of the run in seconds."""
        return float(self.statistics["seconds"]["total"])

    @property
    def warnings(self) -> list[str]:
        """The warnings of the run, which were also issued as Python warnings."""
        return list(self.statistics["warnings"])

    def __repr__(self) -> str:
        rows = f"{self.points_written:,} points"
        if self.points_written != self.points:
            rows = f"{self.points_written:,} of {self.points:,} points"
        return f"<pointsweep.Report: {self.to or 'arrays'}, {rows} in {self.seconds:.2f} s>"

    def _repr_html_(self) -> str:
        rows = [("output", self.to or "arrays"), ("points", f"{self.points:,}"), ("written", f"{self.points_written:,}")]
        return html_table("Report", None, [*rows, ("seconds", f"{self.seconds:.2f}")])


class Arrays(dict):
    """The arrays of a run by name, each with a row for each point: a dict that notebooks show as a table."""

    #: statistics of the run; None for generated points
    report: Report | None = None
    #: the coordinate system of the input of the run, as stated or given
    crs: Crs | None = None
    _components: Mapping[str, list[str]] = {}  # names of the components of arrays, as files have them
    _grid: Grid | None = None  # steps and offsets of the coordinates in the LAS files that the points were read from

    def copy(self) -> Arrays:
        """Returns new `Arrays` with the same arrays, which are not copied, and the same report and coordinate system."""
        return self | {}

    def __or__(self, other: Mapping[str, Any]) -> Arrays:  # type: ignore[override]
        """Returns new `Arrays` with the arrays of both; an array of `other` replaces one of the same name. The report and the
        coordinate system are those of the left operand, or else of the right one."""
        return _united(self, other) if isinstance(other, Mapping) else NotImplemented

    def __ior__(self, other: Any) -> Arrays:  # type: ignore[misc]
        united = _united(self, other if isinstance(other, Mapping) else dict(other))
        self.update(united)
        self.__dict__.update(united.__dict__)
        return self

    def __ror__(self, other: Mapping[str, Any]) -> Arrays:  # type: ignore[override]
        return _united(other, self) if isinstance(other, Mapping) else NotImplemented

    def columns(self) -> dict[str, np.ndarray]:
        """Returns an (n,) array for each component, under its name in files: x, y, z, nx, ny, nz, outlier, ..."""
        flat: dict[str, np.ndarray] = {}
        for name, values in self.items():
            if values.ndim == 1:
                flat[name] = values
                continue
            known = self._components.get(name)
            components = known or [f"{name}_{i}" for i in range(values.shape[1])]
            flat.update((component, values[:, i]) for i, component in enumerate(components))
        return flat

    def to_structured(self) -> np.ndarray:
        """Returns a structured array with a field for each of `columns()`: a copy."""
        flat = self.columns()
        n = len(next(iter(flat.values()), ()))
        rows = np.empty(n, [(name, values.dtype) for name, values in flat.items()])
        for name, values in flat.items():
            rows[name] = values
        return rows

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a pandas.DataFrame with a column for each of `columns()`."""
        import pandas

        return self._marked(pandas.DataFrame(self.columns(), copy=False))

    def to_geopandas(self) -> geopandas.GeoDataFrame:
        """Returns a geopandas.GeoDataFrame: points with heights from 'xyz', the other columns of `columns()`, and the
        coordinate system of the input."""
        import geopandas

        if "xyz" not in self:
            raise UsageError("to_geopandas: there is no 'xyz'; name it in keep.")
        x, y, z = self["xyz"].T
        flat = {name: values for name, values in self.columns().items() if name not in ("x", "y", "z")}
        points = geopandas.points_from_xy(x, y, z)
        return self._marked(geopandas.GeoDataFrame(flat, geometry=points, crs=self.crs))

    def to_arrow(self) -> pyarrow.Table:
        """Returns a pyarrow.Table with a column for each of `columns()`."""
        import pyarrow

        columns = {name: np.ascontiguousarray(values) for name, values in self.columns().items()}
        return pyarrow.table(columns, metadata={ROW_NUMBERS: _MEANING_OF_ROW} if "row" in self else None)

    def _marked(self, frame: Any) -> Any:
        """Returns the data frame with a note that its column 'row', if it has one, is not an attribute of the points."""
        if "row" in self:
            frame.attrs[ROW_NUMBERS] = _MEANING_OF_ROW
        return frame

    def __repr__(self) -> str:
        n = len(next(iter(self.values()), ()))
        lines = [f"<pointsweep.Arrays: {n:,} points"]
        lines += [f"  {name:<20} {values.dtype!s:<8} {values.shape}" for name, values in self.items()]
        return "\n".join(lines) + ">"

    def _repr_html_(self) -> str:
        n = len(next(iter(self.values()), ()))
        rows = [(name, str(a.dtype), str(a.shape), *_least_and_greatest(a)) for name, a in self.items()]
        return html_table(f"{n:,} points", ("array", "type", "shape", "least", "greatest"), rows)


def _united(left: Mapping[str, Any], right: Mapping[str, Any]) -> Arrays:
    result = Arrays({**left, **right})
    for operand in (right, left):
        if isinstance(operand, Arrays):
            known = {name: value for name, value in vars(operand).items() if value is not None}
            result.__dict__.update(known)
    result._components = {n: names for o in (left, right) if isinstance(o, Arrays) for n, names in o._components.items()}
    return result


def _least_and_greatest(values: np.ndarray) -> tuple[str, str]:
    """Returns the least and greatest value as text."""
    import warnings

    if values.size == 0:
        return "", ""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # raised if all values are NaN
        return f"{np.nanmin(values):.6g}", f"{np.nanmax(values):.6g}"


def arrays_of(
    known: dict[str, tuple[np.ndarray, list[str]]],
    statistics: str | None,
    keep: list[str] | None = None,
    crs: Crs | None = None,
    grid: Grid | None = None,
) -> Arrays:
    """Makes the arrays, with the names of their components, in the order of `keep`, else in their own order."""
    result = Arrays({name: known[name][0] for name in keep or known})
    result._components = {name: components for name, (_, components) in known.items()}
    result.crs, result._grid = crs, grid
    if statistics is not None:
        result.report = Report(statistics)
    return result
