# SPDX-License-Identifier: MIT
"""A test of whether an operator is a pure function of a point and its neighbours."""

from __future__ import annotations

import copy
from typing import Any, NamedTuple

import numpy as np

from ._errors import UsageError
from ._generate import generate
from ._operator import Operator, Select
from ._options import run_options
from ._pipeline import Pipeline
from ._runs import run
from ._sources import source_of
from ._types import PipelineLike


class Difference(NamedTuple):
    """A difference between two runs."""

    run: str  #: name of this run, which says what differs from the first run: 'four threads'
    attribute: str  #: the attribute that differs; 'row': other points were kept
    rows: np.ndarray  #: rows with different values; empty if the number of rows differs


class Check:
    """The result of `check`. True if nothing differs."""

    def __init__(self, name: str, points: int, runs: list[str], differences: list[Difference]) -> None:
        self.name, self.points, self.runs, self.differences = name, points, runs, differences

    def __bool__(self) -> bool:
        return not self.differences

    def __repr__(self) -> str:
        head = f"{self.name}: {len(self.runs)} runs over {self.points:,} points"
        if self:
            return f"<pointsweep.Check: {head}, all with the same bytes>"
        lines = [f"  {d.run}: {d.attribute} differs in {len(d.rows):,} rows" + _first(d.rows) for d in self.differences]
        return "\n".join([f"<pointsweep.Check: {head}: not a pure function of a point and its neighbours", *lines]) + ">"


def _first(rows: np.ndarray) -> str:
    return f", the first of them {rows[0]}" if len(rows) else ""


def check(
    operator: Operator, points: Any = None, before: PipelineLike = "knn(k=8) | normals", **options: Any
) -> Check:
    """Runs an operator in different batches, orders, threads and memory, and compares the bytes of its results.

    Parameters
    ----------
    operator : an operator made with `operator` or `select`.
    points : as for `run`, but not an iterator; default: 5,000 points of a surface with some outliers.
    before : a pipeline that makes the attributes that the operator reads.
    options : options of `run`, e.g. attributes.

    Equal results do not prove that a function is pure. They only show that it gives equal results in these runs.
    """
    if not isinstance(operator, Operator):
        raise UsageError("check: give an operator, made with @pointsweep.operator or @pointsweep.select.")
    if points is None:
        points = generate("statue", 5000, noise=0.001, outliers=0.01)["xyz"]
    keep = ["xyz"] if isinstance(operator, Select) else list(operator.makes)
    variants: list[tuple[str, int, dict[str, Any]]] = [
        ("the same again", operator._most_places, {"threads": 1}),
        ("batches of one point", 1, {"threads": 1}),
        ("batches of some points", 500, {"threads": 1}),
        ("four threads", operator._most_places, {"threads": 4}),
        ("four threads, batches of some points", 333, {"threads": 4}),
        ("order='sweep'", operator._most_places, {"order": "sweep"}),
    ]

    def results(places: int, given: dict[str, Any]) -> dict[str, np.ndarray]:
        varied = copy.copy(operator)
        varied._most_places = places
        asked = {**options, **given}
        found = run(points, Pipeline(before, varied), keep=[*keep, *_row_name(points, operator, asked)], **asked)
        if "row" in found and asked.get("order") == "sweep":
            by_row = np.argsort(found["row"], kind="stable")
            return {name: values[by_row] for name, values in found.items()}
        return dict(found)

    expected = results(operator._most_places, {"threads": 1})
    differences = []
    done = []
    for text, places, given in variants:
        if given.get("order") == "sweep" and not _has_rows(points):
            continue
        done.append(text)
        found = results(places, given)
        differences += [Difference(text, *d) for d in _differences(expected, found)]
    n = len(next(iter(expected.values())))
    return Check(operator.name, n, done, differences)


def _has_rows(points: Any) -> bool:
    return not source_of(points, None, None, run_options()).is_files


def _row_name(points: Any, operator: Operator, given: dict[str, Any]) -> list[str]:
    """Returns the name of the row numbers if the points have them and the comparison needs them."""
    needed = isinstance(operator, Select) or given.get("order") == "sweep"
    return ["row"] if needed and _has_rows(points) else []


def _differences(expected: dict[str, np.ndarray], found: dict[str, np.ndarray]) -> list[tuple[str, np.ndarray]]:
    result = []
    for name, values in expected.items():
        other = found[name]
        if other.shape != values.shape:
            return [("row", np.empty(0, np.int64))]
        rows = np.ascontiguousarray(values).view(np.uint8).reshape(len(values), -1)
        others = np.ascontiguousarray(other).view(np.uint8).reshape(len(values), -1)
        differing = np.flatnonzero((rows != others).any(1))
        if len(differing):
            result.append((name, differing))
    return result
