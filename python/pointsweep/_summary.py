# SPDX-License-Identifier: MIT
"""Statistics of points, of all of them or by the values of an attribute."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, overload

import numpy as np

from . import _core
from ._errors import warn
from ._options import count, names, one_name, run_options
from ._progress import called
from ._sources import source_of
from ._tables import html_table
from ._types import ProgressCallback, SummaryOptions

if TYPE_CHECKING:
    import pandas
    from typing_extensions import Unpack


class AttributeSummary(NamedTuple):
    """The finite values of one attribute, all components together. `min`, `max` and quantiles are int if the attribute
    has whole numbers of any size, else float; NaN without a value. The quantile of p percent is the value of
    rank floor(p / 100 * (count - 1)), ascending from 0."""

    count: int  # type: ignore[assignment]  #: finite values, in place of tuple.count
    nonfinite: int  #: NaN and infinite values
    min: int | float
    max: int | float
    mean: float  #: the exact sum, rounded, divided by the count; NaN where the sum is beyond float64
    deviation: float  #: standard deviation, with the divisor count - 1; NaN for fewer than two values, and where squares are beyond float64
    quantiles: dict[int, int | float]  #: by percentage: 1, 5, 25, 50, 75, 95, 99

    @property
    def median(self) -> int | float:
        """The quantile of 50 percent, which is a value that occurs."""
        return self.quantiles[50]


class Histogram(NamedTuple):
    """Counts of the finite values of one attribute. ``edges[i] <= value < edges[i + 1]`` in bin i."""

    edges: np.ndarray  #: (bins + 1,) float64, multiples of 1, 2 or 5 times a power of ten; empty without a finite value
    counts: np.ndarray  #: (bins,) int64


class PointSummary(NamedTuple):
    """Statistics of some points; made with `summary`."""

    points: int
    attributes: dict[str, AttributeSummary]  #: in the order of the cloud, coordinates included
    histograms: dict[str, Histogram]

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a pandas.DataFrame with a row for each attribute: count, nonfinite, min, 1%, ... 99%, max, mean, deviation."""
        import pandas

        return pandas.DataFrame.from_dict({name: _row(a) for name, a in self.attributes.items()}, orient="index")

    def __repr__(self) -> str:
        lines = [f"{name:<20} {_text(a)}" for name, a in self.attributes.items()]
        return "\n  ".join([f"<pointsweep.PointSummary of {self.points:,} points", *lines]) + ">"

    def _repr_html_(self) -> str:
        rows = {name: _row(a) for name, a in self.attributes.items()}
        header = ["attribute", *next(iter(rows.values()), {})]
        cells = [[name, *(_number(v) for v in row.values())] for name, row in rows.items()]
        return html_table(f"{self.points:,} points", header, cells)


class GroupedSummary(Mapping[int, PointSummary]):
    """The statistics of the points of each value of an attribute, ascending by value; made with `summary`."""

    def __init__(self, by: str, groups: dict[int, PointSummary]) -> None:
        self.by = by  #: name of the attribute
        self._groups = groups

    @property
    def points(self) -> dict[int, int]:
        """The number of points of each value."""
        return {value: group.points for value, group in self._groups.items()}

    def __getitem__(self, value: int) -> PointSummary:
        return self._groups[value]

    def __iter__(self) -> Iterator[int]:
        return iter(self._groups)

    def __len__(self) -> int:
        return len(self._groups)

    def to_pandas(self) -> pandas.DataFrame:
        """Returns a pandas.DataFrame with a row for each value, which is its index: points, and for each attribute columns
        such as z_count, z_min, z_50%, z_mean."""
        import pandas

        rows = {
            value: {
                "points": group.points,
                **{f"{name}_{key}": v for name, a in group.attributes.items() for key, v in _row(a).items()},
            }
            for value, group in self._groups.items()
        }
        return pandas.DataFrame.from_dict(rows, orient="index").rename_axis(self.by)

    def __repr__(self) -> str:
        lines = [f"{value}: {group.points:,} points" for value, group in self._groups.items()]
        return "\n  ".join([f"<pointsweep.GroupedSummary by {self.by}", *lines]) + ">"

    def _repr_html_(self) -> str:
        rows = []
        for value, group in self._groups.items():
            row = [str(value), f"{group.points:,}"]
            rows.append(row + [_number(a.mean) for a in group.attributes.values()])
        first = next(iter(self._groups.values()), None)
        means = [] if first is None else [f"mean {name}" for name in first.attributes]
        return html_table(f"points by {self.by}", [self.by, "points", *means], rows)


class _Options(SummaryOptions, total=False):
    attributes: Mapping[str, Any] | None
    ignore_crs: bool


@overload
def summary(points: Any, *, by: None = None, **options: Unpack[_Options]) -> PointSummary: ...


@overload
def summary(points: Any, *, by: str, **options: Unpack[_Options]) -> GroupedSummary: ...


def summary(
    points: Any,
    *,
    by: str | None = None,
    histogram: Sequence[str] | str | None = None,
    bins: int = 20,
    keep: Sequence[str] | str | None = None,
    attributes: Mapping[str, Any] | None = None,
    ignore_crs: bool = False,
    progress: ProgressCallback | bool | None = None,
) -> PointSummary | GroupedSummary:
    """Computes exact statistics of points, like ``pointsweep info --stats``: count, range, mean, deviation, quantiles.

    Parameters
    ----------
    points, attributes, ignore_crs, progress : as for `run`.
    by : an attribute whose values are whole numbers, such as 'classification': the points of each value, at most 10,000
        values, are summarized separately.
    histogram : attributes whose values are counted in bins; all values of `by` have the same edges.
    bins : largest number of bins of a histogram, 2 to 1,000.
    keep : compute only the statistics of these attributes; [] for none, which suffices for the counts of `by`.
        In `keep` and `histogram` an array of several columns stands for all of them: 'xyz' for 'x', 'y' and 'z'.

    Files are read three to five times, in blocks. Memory: at most 256 MB, and less than 100 MB without `by`.

    Returns
    -------
    `PointSummary`, or with `by` a `GroupedSummary`, a mapping from each value to a `PointSummary`.

    Raises
    ------
    UsageError : for an unknown attribute, and for `by` with a value that is no whole number or with too many values.
    Error : for files that cannot be read.

    Examples
    --------
    >>> ps.open("scan.laz").summary().attributes["z"].quantiles[95]
    >>> ps.open("tiles/*.laz").summary(by="classification", keep="z").to_pandas()
    """
    import json

    source = source_of(points, attributes, None, run_options(ignore_crs=ignore_crs))
    components = dict(source.groups)

    def fields(option: str, named: Sequence[str] | str | None) -> list[str]:
        return [field for name in names(option, named) for field in components.get(name, [name])]

    kept = fields("keep", keep)
    given = {
        **source.options,
        "by": "" if by is None else one_name("by", by),
        "values": keep is None or len(kept) > 0,
        "keep": kept,
        "histograms": fields("histogram", histogram),
        "bins": count("bins", bins),
    }
    with called(progress) as shown:
        known = json.loads(_core.statistics(source.inputs, given, shown, warn))
    percent = known["percent"]
    groups = {group["value"]: _group(group, percent) for group in known["groups"]}
    return groups[None] if by is None else GroupedSummary(known["by"], groups)


def _group(known: dict[str, Any], percent: list[int]) -> PointSummary:
    def of(a: dict[str, Any]) -> AttributeSummary:
        a = {key: math.nan if value is None else value for key, value in a.items()}
        quantiles = a["quantiles"] if a["count"] > 0 else [math.nan] * len(percent)
        return AttributeSummary(
            a["count"], a["nonfinite"], a["min"], a["max"], a["mean"], a["deviation"], dict(zip(percent, quantiles))
        )

    histograms = {
        h["name"]: Histogram(np.array(h["edges"], np.float64), np.array(h["counts"], np.int64)) for h in known["histograms"]
    }
    return PointSummary(known["points"], {a["name"]: of(a) for a in known["attributes"]}, histograms)


def _row(a: AttributeSummary) -> dict[str, int | float]:
    return {
        "count": a.count,
        "nonfinite": a.nonfinite,
        "min": a.min,
        **{f"{percent}%": value for percent, value in a.quantiles.items()},
        "max": a.max,
        "mean": a.mean,
        "deviation": a.deviation,
    }


def _number(value: float) -> str:
    return str(value) if isinstance(value, int) else f"{value:.10g}"


def _text(a: AttributeSummary) -> str:
    return f"{_number(a.min)} .. {_number(a.max)}, mean {_number(a.mean)}, median {_number(a.median)}, deviation {a.deviation:.6g}"
