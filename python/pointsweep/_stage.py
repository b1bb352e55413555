# SPDX-License-Identifier: MIT
"""Built-in operators with their options, as stages of pipelines."""

from __future__ import annotations

import functools
import itertools
import os
import re
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any, TypeVar

import numpy as np

from ._adapters import are_points
from ._errors import UsageError
from ._options import names, number, path, text, whole
from ._pipeline import Joinable
from ._types import Files, FunctionStage

_Function = TypeVar("_Function", bound=Callable[..., Any])

#: the key under which each type of GeoJSON object holds other objects
_PARTS = {"FeatureCollection": "features", "Feature": "geometry", "GeometryCollection": "geometries"}


class Stage(Joinable):
    """A built-in operator with its options: ``ps.knn(16)``, ``ps.normals(orient="up")``.

    Stages, operators of your own and texts are joined by ``|``. Call a stage on points to run it:
    ``ps.features(k=16)(xyz)``. `str` gives the stage in the language of docs/pipelines.md. Stages are equal if they are
    the same with all defaults written out, and can be pickled.
    """

    def __init__(self, name: str, options: Mapping[str, str], neighborhood: Mapping[str, str]) -> None:
        self.name = name
        self.options = dict(options)  #: as text, by name; other options have their defaults
        self.neighborhood = dict(neighborhood)  #: k and radius, as text; empty: the neighbourhood of the pipeline

    def _stages(self) -> list[str | FunctionStage]:
        return [str(self)]

    def __str__(self) -> str:
        stage = _text_of_stage(self.name, self.options)
        return f"{_text_of_stage('knn', self.neighborhood)} | {stage}" if self.neighborhood else stage

    def __repr__(self) -> str:
        return f"<pointsweep.Stage: {self}>"


def _text_of_stage(name: str, options: Mapping[str, str]) -> str:
    return f"{name}({', '.join(f'{option}={text}' for option, text in options.items())})" if options else name


def made_stage(
    name: str, options: Iterable[tuple[str, str, Any, Any]], k: int | None = None, radius: float | None = None
) -> Stage:
    """Makes a stage from (name, kind, value, default) of each option, with the kinds of the operator's declaration. `k` and
    `radius` are the neighbourhood of a pipeline that begins with this stage."""
    neighborhood = [("k", "whole", k, None), ("radius", "number", radius, None)]
    return Stage(name, _texts_of(name, options), _texts_of(name, neighborhood))


def makes_stage(function: _Function) -> _Function:
    """Returns `function`, which makes a stage, with a check that refuses points as an argument."""
    takes_files = {name for name, kind in function.__annotations__.items() if "PathLike" in kind}
    takes_arrays = {name for name, kind in function.__annotations__.items() if "ArrayLike" in kind}
    positional = function.__code__.co_varnames[: function.__code__.co_argcount]

    called = f"pointsweep.{function.__name__} makes a stage, which is then called on points: pointsweep.{function.__name__}(...)(points)."

    @functools.wraps(function)
    def checked(*arguments: Any, **options: Any) -> Any:
        for name, value in [*itertools.zip_longest(positional[: len(arguments)], arguments), *options.items()]:
            if name == "polygon" and _is_shape(value):
                continue
            if name in takes_arrays and are_points(value):
                if not _is_matrix(value):
                    raise UsageError(f"{name}: {type(value).__name__} is no matrix of 4 rows of 4 numbers. {called}")
                continue
            if name == "bounds" and _are_corners(value):
                raise UsageError(f"{name}: give the numbers one after another: (*low, *high) for the corners low and high.")
            if name == "polygon" and are_points(value) and not isinstance(value, Files):
                raise UsageError(f"{name}: this {type(value).__name__} is no polygon; give GeoJSON, WKT, a shape of shapely or a path.")
            if name in takes_files and not isinstance(value, Files) and are_points(value):
                raise UsageError(f"{name}: {type(value).__name__} is not a path; write these points to a file. {called}")
            if name not in takes_files and are_points(value):
                raise UsageError(f"{type(value).__name__} is no option. {called}")
        return function(*arguments, **options)

    return checked  # type: ignore[return-value]


def former_name(name: str, function: _Function) -> _Function:
    """Returns `function` under a former name, which works for one release and warns with the new name."""

    @functools.wraps(function)
    def renamed(*arguments: Any, **options: Any) -> Any:
        warnings.warn(
            f"pointsweep.{name} is now called pointsweep.{function.__name__}; the former name will go with the next release.",
            DeprecationWarning,
            stacklevel=2,
        )
        return function(*arguments, **options)

    renamed.__name__ = renamed.__qualname__ = name
    return renamed  # type: ignore[return-value]


def _texts_of(stage: str, options: Iterable[tuple[str, str, Any, Any]]) -> dict[str, str]:
    """Returns the texts of the options that have a value other than None and their default."""
    return {
        name: _text_of(f"{stage}: {name}", kind, value)
        for name, kind, value, default in options
        if value is not None and (default is None or value != default)
    }


def _path_of(where: str, value: Any) -> str:
    if where == "crop: polygon" and _is_shape(value):
        return _polygons_as_text(where, value)
    if isinstance(value, Files):
        if len(value.files) > 1:
            raise UsageError(f"{where}: is a cloud of {len(value.files)} files; give their folder or a pattern instead.")
        return path(where, value.files[0])
    return path(where, value)


def _is_matrix(value: Any) -> bool:
    """Returns whether the value holds the rows of a 4x4 matrix, or the first three of them."""
    return (isinstance(value, (list, tuple)) or hasattr(value, "__array__")) and np.shape(value) in ((4, 4), (3, 4))


def _text_of_matrix(where: str, value: Any) -> str:
    if not _is_matrix(value):
        raise UsageError(f"{where}: {value!r} is neither a matrix of 4 rows of 4 numbers nor a path.")
    return f"[{','.join(repr(number(where, c)) for row in value for c in row)}]"


def _text_of(where: str, kind: str, value: Any) -> str:
    if kind == "whole":
        return str(whole(where, value))
    if kind == "number":
        return repr(number(where, value))
    if "|" in kind:
        if not isinstance(value, bool):
            raise UsageError(f"{where}: {value!r} is neither True nor False.")
        return kind.split("|")[value]
    if kind in ("point", "numbers"):
        if isinstance(value, str) or not isinstance(value, Iterable) or (kind == "point" and np.asarray(value).shape != (3,)):
            raise UsageError(f"{where}: give {'three numbers, (x, y, z)' if kind == 'point' else 'a list of numbers'}.")
        return f"[{','.join(repr(number(where, c)) for c in value)}]"
    if kind in ("names", "attributes"):
        return f"[{','.join(names(where, value))}]"
    if kind == "matrix" and not isinstance(value, (str, os.PathLike)):
        return _text_of_matrix(where, value)
    if kind == "matrix":
        value = path(where, value)
    if kind == "file":
        value = _path_of(where, value)
    if re.fullmatch(r"[A-Za-z0-9_]+", text(where, value)):
        return value
    return '"' + value.replace("\\", "\\\\").replace('"', '\\"') + '"'


def _are_corners(value: Any) -> bool:
    """Returns whether the value is a pair of corners with two or three coordinates each, such as `Cloud.bounds`."""
    return isinstance(value, (list, tuple, np.ndarray)) and len(value) == 2 and all(np.size(corner) in (2, 3) for corner in value)


def _is_shape(value: Any) -> bool:
    """Returns whether the value is a geometry: an object with a geo interface, or GeoJSON as a dict. Text, paths and arrays are not."""
    return hasattr(value, "__geo_interface__") or (isinstance(value, Mapping) and isinstance(value.get("type"), str))


def _polygons_as_text(where: str, shape: Any) -> str:
    """Returns all polygons of `shape` as WKT, with unchanged x and y and without heights. Errors begin with `where`."""
    geometry = shape if isinstance(shape, Mapping) else shape.__geo_interface__
    try:
        polygons = list(_polygons_of(where, geometry))
    except (KeyError, TypeError, ValueError) as error:
        if isinstance(error, UsageError):
            raise
        raise UsageError(f"{where}: is no valid GeoJSON ({type(error).__name__}: {error}); give a 'type' with its 'coordinates'.") from None
    if not polygons:
        raise UsageError(f"{where}: there are no polygons in this {type(shape).__name__}; give one or more.")
    return f"MULTIPOLYGON ({', '.join(polygons)})"


def _polygons_of(where: str, geometry: Mapping[str, Any] | None) -> Iterator[str]:
    if geometry is None:  # a feature may have no geometry
        return
    kind = geometry["type"]
    if kind in _PARTS:
        parts = geometry[_PARTS[kind]]
        for part in parts if isinstance(parts, (list, tuple)) else [parts]:
            yield from _polygons_of(where, part)
    elif kind in ("Polygon", "MultiPolygon"):
        for rings in [geometry["coordinates"]] if kind == "Polygon" else geometry["coordinates"]:
            if rings:
                yield f"({', '.join(_ring(ring) for ring in rings)})"
    else:
        raise UsageError(f"{where}: a {kind} has no inside; give polygons, or the polygons of a buffer around it.")


def _ring(places: Any) -> str:
    return f"({', '.join(f'{float(x)!r} {float(y)!r}' for x, y, *_ in places)})"
