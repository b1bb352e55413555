# SPDX-License-Identifier: MIT
"""The two most frequent runs, each as one function."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Literal, overload

import numpy as np

from . import _core, _stages
from ._errors import UsageError, warn
from ._options import OPTIONS_OF_FILES, choice, number, refuse_options, run_options, whole, with_run_options
from ._progress import called
from ._results import Neighbors, RadiusNeighbors
from ._runs import run
from ._sources import positions_of, source_of
from ._stage import Stage
from ._types import PointOptions, ProgressCallback, RunOptions

if TYPE_CHECKING:
    from typing_extensions import Unpack


_Orient = Literal["none", "up", "viewpoint", "input"]


@overload
def normals(
    points: None = None,
    k: int | None = None,
    *,
    radius: float | None = None,
    orient: _Orient = "none",
    viewpoint: Sequence[float] | None = None,
) -> Stage: ...


@overload
def normals(
    points: Any,
    k: int | None = None,
    *,
    radius: float | None = None,
    orient: _Orient = "none",
    viewpoint: Sequence[float] | None = None,
    out: np.ndarray | None = None,
    **options: Unpack[PointOptions],
) -> np.ndarray: ...


@with_run_options
def normals(
    points: Any = None,
    k: int | None = None,
    *,
    radius: float | None = None,
    orient: _Orient = "none",
    viewpoint: Sequence[float] | None = None,
    out: np.ndarray | None = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    progress: ProgressCallback | bool | None = None,
    **options: Unpack[RunOptions],
) -> np.ndarray | Stage:
    """Returns unit normals of the surface at the points, (n, 3) float32; without points, a stage that makes them:
    ``ps.knn(16) | ps.normals(orient="up")``.

    Parameters
    ----------
    points : as for `run`.
    k : number of neighbours; default without a radius: 16, as in docs/operators.md.
    radius : neighbours lie within it, in the unit of the coordinates; with `k`, at most k of them.
    orient : 'none' (the component of largest magnitude is positive), 'up' (nz >= 0), 'viewpoint', or 'input' (as the
        attribute 'normal' that the points have).
    viewpoint : the position of the scanner, x, y, z; implies orient='viewpoint'.
    out : an array that the normals are written to.
    attributes, crs, progress and the other options : as for `run`.
    """
    if viewpoint is not None and orient == "none":
        orient = "viewpoint"
    choice("orient", orient, ("none", "up", "viewpoint", "input"))
    if orient == "viewpoint" and np.asarray(viewpoint).shape != (3,):
        raise UsageError("viewpoint: give the position of the scanner, (x, y, z).")
    if orient != "viewpoint" and viewpoint is not None:
        raise UsageError(f"viewpoint: is not used with orient={orient!r}; leave one of them out.")
    stage = _stages.normals(orient, viewpoint=viewpoint, k=k, radius=radius)
    if points is not None:
        into = None if out is None else {"normal": out}
        return run(
            points,
            stage,
            keep=["normal"],
            out=into,
            attributes=attributes,
            crs=crs,
            progress=progress,
            **options,
        )["normal"]
    given = {"out": out, "attributes": attributes, "crs": crs, "progress": progress, **options}
    unused = [name for name, value in given.items() if value is not None]
    if unused:
        raise UsageError(f"normals: without points it is a stage, which has no {unused[0]}; call the stage with it.")
    return stage


# Appends the section of the stage's docstring that describes the results.
normals.__doc__ = f"{normals.__doc__ or ''}\n    Makes\n{(_stages.normals.__doc__ or '').partition('Makes')[2].lstrip(chr(10))}"


@overload
def neighbors(
    points: Any,
    k: int,
    *,
    radius: float | None = None,
    queries: Any = None,
    **options: Unpack[PointOptions],
) -> Neighbors: ...


@overload
def neighbors(
    points: Any,
    k: None = None,
    *,
    radius: None = None,
    queries: Any = None,
    **options: Unpack[PointOptions],
) -> Neighbors: ...


@overload
def neighbors(
    points: Any,
    k: None = None,
    *,
    radius: float,
    queries: Any = None,
    **options: Unpack[PointOptions],
) -> RadiusNeighbors: ...


@with_run_options
def neighbors(
    points: Any,
    k: int | None = None,
    *,
    radius: float | None = None,
    queries: Any = None,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    progress: ProgressCallback | bool | None = None,
    **options: Unpack[RunOptions],
) -> Neighbors | RadiusNeighbors:
    """Finds the exact neighbours of every point among all points, the point itself excluded; or of other positions.

    Parameters
    ----------
    points : as for `run`.
    k : number of neighbours; default without a radius: 16.
    radius : largest distance, inclusive, in the unit of the coordinates.
    queries : (m, 3) positions, in any form of points in arrays. Neighbours of these positions are found instead, among
        the points. A point that coincides with a query is its nearest neighbour, at the distance 0.
    attributes, crs, progress and the other options : as for `run`.

    Returns
    -------
    With k: `Neighbors`, (indices, distances), both (n, k), nearest first. With a radius alone: `RadiusNeighbors`,
    (offsets, indices, distances); the neighbours of point i are ``indices[offsets[i]:offsets[i + 1]]``, nearest first.
    Their number is not bounded: 16 bytes for each are in memory, whatever `memory` says.
    With queries: the same with a row for each query, (m, k), or m + 1 offsets; indices are rows of the points.

    Distances are computed in float64; equal ones are ordered by x, y, z, then by row. Points with NaN or infinite
    coordinates have no neighbours and are neighbours of no point; with nonfinite='drop' they have no rows, and rows are
    counted without them. Queries with such coordinates have no neighbours, and keep their rows in any case.
    """
    source = source_of(points, attributes, crs, run_options(**options))
    given = source.options
    refuse_options(given, ("order", "positions", *OPTIONS_OF_FILES), "is not an option of neighbors")
    asked = None if queries is None else positions_of("queries", queries, source, given["ignore_crs"])
    if k is None and radius is not None:
        limit = number("radius", radius)
        with called(progress) as shown:
            return RadiusNeighbors(*_core.radius_neighbors(source.inputs, asked, limit, given, shown, warn))
    count = _core.default_neighbors if k is None else whole("k", k)
    if not 1 <= count < 2**32:
        raise UsageError(f"k: {count} is not a number of neighbours; choose 1 or more, below 2**32.")
    limit = math.inf if radius is None else number("radius", radius)
    with called(progress) as shown:
        return Neighbors(*_core.neighbors(source.inputs, asked, count, limit, given, shown, warn))
