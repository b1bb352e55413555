# SPDX-License-Identifier: MIT
"""Runs over arrays and files."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal, overload

import numpy as np

from . import _core
from ._errors import UsageError, warn
from ._files import outputs_of
from ._options import choice, names, number, run_options, whole
from ._pipeline import PipelineLike, stages_of
from ._results import Arrays, Neighbors, RadiusNeighbors, Report, arrays_of
from ._sources import Source, source_of

#: (phase, points done, points in all)
ProgressCallback = Callable[[str, int, int], Any]
Path = str | os.PathLike[str]


@overload
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: None = None,
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    order: str = "input",
    axis: int | str | None = None,
    memory: int | str | None = None,
    threads: int | None = None,
    temp_folder: Path | None = None,
    resume: Path | None = None,
    nonfinite: str | None = None,
    overwrite: bool = False,
    replace: Sequence[str] | str | None = None,
    prefix: str = "",
    progress: ProgressCallback | None = None,
) -> Arrays: ...


@overload
def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | Sequence[Path],
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    order: str = "input",
    axis: int | str | None = None,
    memory: int | str | None = None,
    threads: int | None = None,
    temp_folder: Path | None = None,
    resume: Path | None = None,
    nonfinite: str | None = None,
    overwrite: bool = False,
    replace: Sequence[str] | str | None = None,
    prefix: str = "",
    progress: ProgressCallback | None = None,
) -> Report: ...


def run(
    points: Any,
    pipeline: PipelineLike,
    *,
    to: Path | Sequence[Path] | None = None,
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    progress: ProgressCallback | None = None,
    **options: Any,
) -> Arrays | Report:
    """Runs a pipeline over points, in arrays or files, and returns arrays or writes files.

    Parameters
    ----------
    points : an (n, 3) array of any strides, also memory-mapped; a dict of arrays with 'xyz' (or 'x', 'y', 'z') and more
        attributes; a structured array with fields x, y, z; a `Cloud`; or paths as `open` takes them.
    pipeline : a text such as ``"knn(k=16) | normals | sor"`` (docs/pipelines.md), an operator of your own, or both in a
        list or joined by ``|``; or the path of a text file.
    to : the file to write, whose name says the format; a folder, with a file for each input file; None: arrays.
    keep : names of the attributes wanted. Without it arrays are returned of all that is made; where the pipeline leaves
        rows out, or the order is another one, also of everything that the input has, and of 'row', the number of the
        input row (of points in arrays).
    attributes : more attributes of points in arrays, by name.
    order : of the result's rows: 'input', or 'sweep', along the axis of the largest extent.
    axis : of the sweep: 'x', 'y' or 'z'.
    memory : what the run may take in addition to the interpreter, its arrays and the results, e.g. '2G'; what does not
        fit goes to temporary files. Default: half of what is available.
    threads : default: one for each core.
    temp_folder : for temporary files.
    resume : a folder for checkpoints: the same call goes on from there after a crash. For files only.
    nonfinite : what happens to points with NaN or infinite coordinates: 'keep' them without results, 'drop' or 'refuse'.
        Default: 'keep', for LAS outputs 'drop'.
    overwrite : the output may replace an existing file.
    replace : attributes of the input that made ones of the same name may replace.
    prefix : before the names of made attributes in files.
    progress : called with (phase, points done, points in all), a few times a second. An exception in it ends the run.

    Returns
    -------
    `Arrays`, a dict of arrays, or a `Report` where files are written. Raises `UsageError` and `Error`. Ctrl-C ends a run
    within a second, and nothing of it remains. Other threads run meanwhile.
    """
    source = source_of(points, attributes)
    stages = stages_of(pipeline)
    kept = names("keep", keep)
    given = {**run_options(**options), **source.options}
    if to is None:
        for option in ("prefix", "resume"):
            if given[option]:
                raise UsageError(f"{option}: is for outputs in files; name one with to=, or leave the option out.")
        arrays, statistics = _core.run(source.inputs, stages, kept, given, source.groups, None, progress, warn)
        return arrays_of(arrays, statistics, kept)
    if given["resume"] and not source.is_files:
        raise UsageError("resume: is for files; arrays are gone when this process ends.")
    files = outputs_of(to, source, points)
    _, statistics = _core.run(source.inputs, stages, kept, given, source.groups, files, progress, warn)
    return Report(statistics, os.fspath(to) if isinstance(to, (str, os.PathLike)) else f"{len(files)} files")


def _knn(k: int | None, radius: float | None) -> str:
    options = []
    if k is not None:
        options.append(f"k={whole('k', k)}")
    if radius is not None:
        options.append(f"radius={number('radius', radius)!r}")
    return f"knn({', '.join(options)})"


def normals(
    points: Any,
    k: int | None = None,
    *,
    radius: float | None = None,
    orient: str = "none",
    viewpoint: Sequence[float] | None = None,
    **options: Any,
) -> np.ndarray:
    """Unit normals of the surface that the points were taken from, (n, 3) float32; 0 where none can be computed.

    Parameters
    ----------
    points : as for `run`.
    k : number of neighbours; 8 where no radius is given.
    radius : neighbours lie within it, in the unit of the coordinates; with `k`, at most k of them.
    orient : 'none' (the component of largest magnitude is positive), 'up' (nz >= 0), 'viewpoint', or 'input' (as the
        attribute 'normal' that the points have).
    viewpoint : the position of the scanner, x, y, z; implies orient='viewpoint'.
    options : of `run`: attributes, memory, threads, progress, ...

    The normal is the eigenvector of the smallest eigenvalue of the covariance of the neighbours, weighted by distance
    (Equation 1 in R. Pajarola, Stream-Processing Points, IEEE Visualization 2005; docs/operators.md).
    """
    if viewpoint is not None and orient == "none":
        orient = "viewpoint"
    stage = f"orient={choice('orient', orient, ('none', 'up', 'viewpoint', 'input'))}"
    if orient == "viewpoint":
        if viewpoint is None or len(viewpoint) != 3:
            raise UsageError("viewpoint: give the position of the scanner, (x, y, z).")
        stage += f", viewpoint=[{','.join(repr(number('viewpoint', c)) for c in viewpoint)}]"
    elif viewpoint is not None:
        raise UsageError(f"viewpoint: is not used with orient={orient!r}; leave one of them out.")
    k = 8 if k is None and radius is None else k
    result: np.ndarray = run(points, f"{_knn(k, radius)} | normals({stage})", keep=["normal"], **options)["normal"]
    return result


@overload
def neighbors(points: Any, k: int = ..., *, radius: float | None = None, **options: Any) -> Neighbors: ...


@overload
def neighbors(points: Any, k: None = None, *, radius: float, **options: Any) -> RadiusNeighbors: ...


def neighbors(
    points: Any, k: int | None = None, *, radius: float | None = None, **options: Any
) -> Neighbors | RadiusNeighbors:
    """The exact neighbours of every point among all points, the point itself excluded.

    Parameters
    ----------
    points : as for `run`.
    k : number of neighbours; 16 where no radius is given.
    radius : largest distance, inclusive, in the unit of the coordinates.
    options : of `run`: memory, threads, progress, ...

    Returns
    -------
    With k: `Neighbors`, (indices, distances), both (n, k), nearest first. With a radius alone: `RadiusNeighbors`,
    (offsets, indices, distances); the neighbours of point i are ``indices[offsets[i]:offsets[i + 1]]``, nearest first.
    Their number is not bounded: 16 bytes for each are in memory, whatever the budget.

    Distances are computed in float64; equal ones are ordered by x, y, z, then by row. Points with NaN or infinite
    coordinates have no neighbours and are neighbours of no point.
    """
    progress = options.pop("progress", None)
    source: Source = source_of(points, options.pop("attributes", None))
    given = {**run_options(**options), **source.options}
    for option, plain in (("order", "input"), ("prefix", ""), ("resume", "")):
        if given[option] != plain:
            raise UsageError(f"{option}: is not an option of neighbors.")
    if k is None and radius is not None:
        lists = _core.radius_neighbors(source.inputs, number("radius", radius), given, progress, warn)
        return RadiusNeighbors(*lists)
    count = 16 if k is None else whole("k", k)
    if count < 1:
        raise UsageError(f"k: {count} is not a number of neighbours; choose 1 or more.")
    limit = math.inf if radius is None else number("radius", radius)
    arrays, _ = _core.neighbors(source.inputs, count, limit, given, progress, warn)
    return Neighbors(arrays["neighbors"], arrays["distances"])
