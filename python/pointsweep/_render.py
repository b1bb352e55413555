# SPDX-License-Identifier: MIT
"""Pictures of clouds."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

from . import _core
from ._errors import UsageError, warn
from ._options import count, flag, number, path, run_options, text
from ._progress import called
from ._sources import source_of
from ._types import Path, ProgressCallback


class Picture:
    """A picture in the format PNG, which notebooks show."""

    def __init__(self, png: bytes, color: str, range: tuple[float, float] | None, outside: int) -> None:
        self.png = png  #: the bytes of a PNG file
        self.color = color  #: source of the colours: 'rgb', 'height', 'classification', ...
        self.range = range  #: the numbers shown as violet and as yellow; None: the colours do not show numbers
        self.outside = outside  #: number of points too far from all others to be in the picture

    def save(self, file: Path, *, overwrite: bool = False) -> None:
        """Writes the picture to a file. Raises `UsageError` unless its name ends with .png, and FileExistsError
        if the file exists, unless `overwrite`."""
        name = os.fspath(path("file", file))
        if not name.lower().endswith(".png"):
            raise UsageError(f"file: {name}: pictures are PNG; give a name that ends with .png.")
        with open(name, "wb" if overwrite else "xb") as out:
            out.write(self.png)

    def _repr_png_(self) -> bytes:
        return self.png

    def __repr__(self) -> str:
        return f"<Picture coloured by {self.color}, {len(self.png):,} bytes>"


def render(
    points: Any,
    *,
    color: str | None = None,
    view: str = "auto",
    up: str = "auto",
    size: tuple[int, int] = (1200, 900),
    point_size: float | None = None,
    background: str = "white",
    legend: bool = True,
    attributes: Mapping[str, Any] | None = None,
    crs: Any = None,
    ignore_crs: bool = False,
    progress: ProgressCallback | bool | None = None,
) -> Picture:
    """Draws points like ``pointsweep render``. A notebook shows the picture if it is the value of the last line of a cell.

    Parameters
    ----------
    points, attributes, crs, ignore_crs, progress : as for `run`.
    color : 'rgb', 'normal', 'height', 'curvature', 'classification', 'plain' or an attribute; None: 'rgb' if it varies,
        else 'plain' with normals, else 'height'. Numbers are coloured from their 5 % to their 95 % quantile.
    view : 'front', 'top', 'iso' or 'AZIMUTH,ELEVATION' in degrees; 'auto': top for flat clouds, else 30,25.
    up : the axis that points up: 'x', 'y', 'z', '-x', '-y', '-z'; 'auto': z for LAS, else found from the shape.
    size : width and height in pixels, 16 to 16,384 each.
    point_size : diameter of every point in pixels; None: splats or radii of the points, else the spacing of the points.
    background : 'white', 'black' or RRGGBB in hexadecimal.
    legend : draw a legend of the colours.

    Points are read twice; files are read in blocks. Memory: 11 to 75 bytes for each pixel, and a sample of 65,536 points.

    Returns
    -------
    `Picture`

    Raises
    ------
    UsageError : for an option out of range or an unknown attribute.
    Error : if no point has finite coordinates, and for files that cannot be read.

    Examples
    --------
    >>> ps.render(ps.open("scan.laz"), color="classification").save("scan.png")
    """
    try:
        width, height = size
    except (TypeError, ValueError):
        raise UsageError(f"size: {size!r} is not a pair of width and height in pixels, e.g. (1200, 900).") from None
    source = source_of(points, attributes, crs, run_options(ignore_crs=ignore_crs))
    diameter = 0.0 if point_size is None else number("point_size", point_size)
    if diameter <= 0 and point_size is not None:
        raise UsageError(f"point_size: {point_size!r} is no diameter in pixels; give a number above 0, or leave the option out.")
    given = {
        **source.options,
        "color": "" if color is None else text("color", color),
        "view": text("view", view),
        "up": text("up", up),
        "width": count("size", width, bits=32),
        "height": count("size", height, bits=32),
        "point_size": diameter,
        "background": text("background", background),
        "legend": flag("legend", legend),
    }
    with called(progress) as shown:
        return Picture(*_core.render(source.inputs, given, shown, warn))
