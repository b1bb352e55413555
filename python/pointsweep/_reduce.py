# SPDX-License-Identifier: MIT
"""A value of the whole cloud."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

from ._chunks import chunks
from ._function import MadeOfFunction
from ._results import Arrays
from ._types import PipelineLike


class Reduction(MadeOfFunction):
    """A function that takes a cloud block by block; made with `pointsweep.reduce`. Call it with points."""

    def __init__(self, function: Callable[[Any, Arrays], Any], start: Any, keep: Any) -> None:
        self._takes_the_place_of(function)
        self.start = start
        self.keep = keep

    def __call__(self, points: Any, pipeline: PipelineLike | None = None, *, rows: int = 1 << 20, **options: Any) -> Any:
        """Reduces the results of a pipeline, or the points themselves. `options` are options of `run`."""
        value = copy.deepcopy(self.start)
        with chunks(points, rows, pipeline, **{"keep": self.keep, **options}) as blocks:
            for block in blocks:
                value = self.function(value, block)
        return value

    def __repr__(self) -> str:
        return f"<pointsweep.Reduction {getattr(self.function, '__name__', '')}>"


def reduce(*, start: Any, keep: Any = None) -> Callable[[Callable[[Any, Arrays], Any]], Reduction]:
    """Turns a function over blocks of rows into a value of the whole cloud, computed in bounded memory.

    Parameters
    ----------
    start : the value before the first block. It is copied for each call.
    keep : the arrays that the function needs, as for `run`.

    The function gets the value so far and a block as `chunks` gives it, and returns the new value. Blocks come in the
    order of the input, `rows` rows each: memory and threads do not change the result.

    >>> @reduce(start=-np.inf, keep=["xyz"])
    ... def highest(z, block):
    ...     return max(z, block["xyz"][:, 2].max())
    >>> highest("tiles/*.laz")
    """
    return lambda function: Reduction(function, start, keep)
