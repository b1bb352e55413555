# SPDX-License-Identifier: MIT
"""Polygons of shapely, geopandas and other objects with ``__geo_interface__``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from ._errors import UsageError

#: for each type of object that holds other geometries, the key of these
_PARTS = {"FeatureCollection": "features", "Feature": "geometry", "GeometryCollection": "geometries"}


def is_shape(value: Any) -> bool:
    """Returns whether the value is a geometry. Text, paths and arrays are not."""
    return hasattr(value, "__geo_interface__")


def polygons_as_text(where: str, shape: Any) -> str:
    """Returns all polygons of `shape` as WKT, with unchanged x and y and without heights. Errors begin with `where`."""
    polygons = list(_polygons_of(where, shape.__geo_interface__))
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
