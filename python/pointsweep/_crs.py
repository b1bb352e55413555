# SPDX-License-Identifier: MIT
"""Coordinate reference systems of files and of points in arrays."""

from __future__ import annotations

import os
import re
from typing import Any

from . import _core
from ._errors import Error, UsageError

_PROJECTION_RECORDS = (2112, 34735, 34736, 34737)  # record numbers of LAS: WKT, and the three of GeoTIFF keys


class Crs:
    """A coordinate reference system that a file or the caller states. ``pyproj.CRS`` accepts it as an argument."""

    def __init__(self, known: tuple[Any, ...]) -> None:
        self._known = known  # the tuple that crs_value() in python/binding/crs_values.h describes
        self.name: str = known[0]  #: name in the file; may be empty
        self.epsg: int = known[2]  #: EPSG code of the horizontal system; 0: not stated
        self.vertical_epsg: int = known[3]  #: EPSG code of the heights; 0: not stated
        self.wkt: str = known[4]  #: well-known text; empty if only GeoTIFF keys state the system

    def to_wkt(self) -> str:
        """Returns the well-known text. For a file with GeoTIFF keys it is made from their EPSG codes, which needs pyproj."""
        if self.wkt:
            return self.wkt
        if not self.epsg:
            raise Error(f"{self}: is stated by GeoTIFF keys without an EPSG code, for which no WKT is known; write it by hand.")
        code = f"EPSG:{self.epsg}" + (f"+{self.vertical_epsg}" if self.vertical_epsg else "")
        return str(_pyproj(code).CRS(code).to_wkt())

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Crs) and self._known == other._known

    def __hash__(self) -> int:
        return hash((self.name, self.epsg, self.wkt))

    def __str__(self) -> str:
        return _core.short_text(self._known)

    def __repr__(self) -> str:
        return f"<pointsweep.Crs: {self}>"


def crs_of(value: Any) -> Crs | None:
    """Converts a value of `crs=`: an EPSG code, WKT, an object of pyproj or another one with `to_wkt`, or the `crs` of a cloud."""
    if value is None or isinstance(value, Crs):
        return value
    if isinstance(value, os.PathLike) or (isinstance(value, str) and value.lower().endswith((".prj", ".wkt"))):
        return _of_file(value)
    if isinstance(value, str) and re.match(r"\s*[A-Za-z_]+\s*[\[(]", value):
        return _of_wkt(value)
    if isinstance(value, (int, str)) and not isinstance(value, bool):
        text = f"EPSG:{value}" if isinstance(value, int) else value
        return _of_wkt(_wkt_of(_looked_up(text)))
    if hasattr(value, "to_wkt"):
        return _of_wkt(_wkt_of(value))
    raise UsageError(f"crs: {value!r} is not a coordinate system; give an EPSG code, WKT or a pyproj.CRS.")


def las_crs(header: Any) -> Crs | None:
    """Returns the coordinate reference system in the records (VLRs and EVLRs) of a header of laspy; None without one."""
    found: dict[int, bytes] = {}
    for record in [*header.vlrs, *(header.evlrs or [])]:
        if record.user_id == "LASF_Projection" and record.record_id in _PROJECTION_RECORDS:
            found.setdefault(record.record_id, record.record_data_bytes())
    wkt_counts = bool(header.global_encoding.wkt) or header.point_format.id >= 6
    wkt, directory, doubles, ascii = (found.get(record, b"") for record in _PROJECTION_RECORDS)
    known = _core.las_crs(wkt, directory, doubles, ascii, wkt_counts)
    return None if known is None else Crs(known)


def given_or_stated(given: Any, stated: Crs | None) -> Crs | None:
    """Returns the system `given` by the caller, or else the system `stated` by the points. Raises UsageError if the two differ."""
    crs = crs_of(given)
    if crs is not None and stated is not None and _core.differ(crs._known, stated._known):
        raise UsageError(f"crs: {crs} is given, but the points state {stated}; leave crs out, or transform the points first.")
    return stated if crs is None else crs


def _of_file(file: str | os.PathLike[str]) -> Crs:
    try:
        with open(file, encoding="utf-8") as text:
            return _of_wkt(text.read())
    except (OSError, UnicodeDecodeError) as error:
        raise UsageError(f"crs: {os.fspath(file)} is no file with WKT: {error}.") from None


def _of_wkt(wkt: str) -> Crs:
    known = _core.wkt_crs(wkt)
    if known is None:
        raise UsageError(f"crs: {wkt[:60]!r} is not well-known text of a coordinate system.")
    return Crs(known)


def _wkt_of(crs: Any) -> str:
    """Returns the system as WKT 1, which LAS requires and all programs read, or else as the object writes it."""
    if type(crs).__module__.startswith("pyproj"):
        from pyproj.exceptions import CRSError

        try:
            return str(crs.to_wkt("WKT1_GDAL"))
        except CRSError:
            pass
    return str(crs.to_wkt())


def _looked_up(text: str) -> Any:
    pyproj = _pyproj(text)
    try:
        return pyproj.CRS(text)
    except pyproj.exceptions.CRSError as error:
        raise UsageError(f"crs: {text!r} is not a coordinate system: {error}.") from None


def _pyproj(text: str) -> Any:
    try:
        import pyproj
    except ImportError:
        raise UsageError(f"crs: pyproj, which looks up {text!r}, is not installed; install it, or give the WKT.") from None
    return pyproj
