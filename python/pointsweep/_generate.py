# SPDX-License-Identifier: MIT
"""Clouds of known geometry, of any size."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypedDict, overload

import numpy as np

from . import _core, _options
from ._errors import UsageError, warn
from ._files import Cloud, open
from ._options import count, flag, number, run_options, text
from ._progress import called
from ._results import Arrays, arrays_of
from ._types import Path, ProgressCallback

if TYPE_CHECKING:
    from typing_extensions import Unpack


class _Options(TypedDict, total=False):
    seed: int
    noise: float
    outliers: float
    outlier_box: float
    origin: Sequence[float] | None
    float64: bool
    overwrite: bool
    threads: int | None
    progress: ProgressCallback | bool | None


@overload
def generate(shape: str, n: int, path: None = None, **options: Unpack[_Options]) -> Arrays: ...


@overload
def generate(shape: str, n: int, path: Path, **options: Unpack[_Options]) -> Cloud: ...


def generate(
    shape: str,
    n: int,
    path: Path | None = None,
    *,
    seed: int = 1,
    noise: float = 0,
    outliers: float = 0,
    outlier_box: float = 20,
    origin: Sequence[float] | None = None,
    float64: bool = False,
    overwrite: bool = False,
    threads: int | None = None,
    progress: ProgressCallback | bool | None = None,
) -> Arrays | Cloud:
    """Makes points of a shape, in random order, with its normals if it has any. The points are equal on all machines.

    Parameters
    ----------
    shape : 'plane', 'sphere', 'cylinder', 'torus', 'statue', 'terrain', 'tls' or 'volume'; lengths are in metres.
    n : number of points.
    path : the file to write, which is returned as a `Cloud`. None: the arrays 'xyz' and 'normal' are returned.
    seed : seed of the random sample, 0 or more, below 2**64.
    noise : standard deviation of Gaussian noise on each coordinate.
    outliers : share of points, 0 to 1, that lie at random in a box of `outlier_box` times the size of the shape.
    origin : x, y, z that are added to every point; implies float64.
    float64 : coordinates as float64 instead of float32.
    overwrite, threads, progress : as for `run`.
    """
    if origin is not None and np.asarray(origin).shape != (3,):
        raise UsageError("origin: give three numbers, (x, y, z).")
    points = count("n", n)
    options = {
        "seed": count("seed", seed),
        "noise": number("noise", noise),
        "outliers": number("outliers", outliers),
        "outlier_box": number("outlier_box", outlier_box),
        "origin": None if origin is None else [number("origin", c) for c in origin],
        "float64": flag("float64", float64),
        "overwrite": flag("overwrite", overwrite),
        "threads": int(run_options(threads=threads)["threads"] or 0),
    }
    file = "" if path is None else _options.path("path", path)
    with called(progress) as shown:
        known = _core.generate(text("shape", shape), points, file, options, shown, warn)
    return open(file) if known is None else arrays_of(known, None)
