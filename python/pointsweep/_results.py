# SPDX-License-Identifier: MIT
"""What runs return."""

from __future__ import annotations

import json
from typing import Any, NamedTuple

import numpy as np


class Neighbors(NamedTuple):
    """The k nearest neighbours of every point, the point itself excluded, nearest first."""

    indices: np.ndarray  #: (n, k) rows, uint32, or uint64 from 2**32 - 1 points on; missing: the largest value
    distances: np.ndarray  #: (n, k) float64; missing: NaN


class RadiusNeighbors(NamedTuple):
    """The neighbours of every point within a radius, nearest first: those of point i are at
    ``offsets[i]:offsets[i + 1]``."""

    offsets: np.ndarray  #: (n + 1,) int64
    indices: np.ndarray  #: rows, uint32, or uint64 from 2**32 - 1 points on
    distances: np.ndarray  #: float64


class Report:
    """What a run did."""

    def __init__(self, statistics: str, to: str | None = None) -> None:
        #: everything the library counts and measures, as `pointsweep run --stats` writes it
        self.statistics: dict[str, Any] = json.loads(statistics)
        #: the file or folder that was written; None: arrays were returned
        self.to = to

    @property
    def points(self) -> int:
        """Points of the input."""
        return int(self.statistics["points"])

    @property
    def points_written(self) -> int:
        """Those of them that are in the output."""
        return int(self.statistics["points_written"])

    @property
    def seconds(self) -> float:
        """Wall time."""
        return float(self.statistics["seconds"]["total"])

    @property
    def warnings(self) -> list[str]:
        """What was also issued as warnings."""
        return list(self.statistics["warnings"])

    def __repr__(self) -> str:
        rows = f"{self.points_written:,} points"
        if self.points_written != self.points:
            rows = f"{self.points_written:,} of {self.points:,} points"
        return f"<pointsweep.Report: {self.to or 'arrays'}, {rows} in {self.seconds:.2f} s>"


class Arrays(dict):
    """The arrays of a run by name, each with a row for each point: a dict that shows itself as a table."""

    #: what the run did; None of generated points
    report: Report | None = None

    def __repr__(self) -> str:
        n = len(next(iter(self.values()), ()))
        lines = [f"<pointsweep.Arrays: {n:,} points"]
        lines += [f"  {name:<20} {values.dtype!s:<8} {values.shape}" for name, values in self.items()]
        return "\n".join(lines) + ">"


def arrays_of(arrays: dict[str, np.ndarray], statistics: str | None, keep: list[str] | None = None) -> Arrays:
    """The arrays in the order of `keep`, else in their own."""
    result = Arrays({name: arrays[name] for name in keep} if keep else arrays)
    if statistics is not None:
        result.report = Report(statistics)
    return result
