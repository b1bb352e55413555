# SPDX-License-Identifier: MIT
"""Statistics of points against numpy, and against the command-line tool."""

import json
import math
import subprocess

import numpy as np
import pytest

import pointsweep as ps

PERCENT = (1, 5, 25, 50, 75, 95, 99)


def points_of(n, seed=5):
    random = np.random.default_rng(seed)
    value = random.normal(0, 1e3, n)
    value[random.random(n) < 0.1] = math.nan
    return {
        "xyz": random.random((n, 3)) * [100, 100, 5] + [431000, 5410000, 300],
        "classification": random.choice(np.array([2, 5, 6], np.uint8), n),
        "value": value,
        "color": random.integers(0, 256, (n, 3)).astype(np.uint8),
    }


def expect(found, values):
    values = np.sort(np.asarray(values).ravel())
    finite = values[np.isfinite(values)]
    assert (found.count, found.nonfinite) == (len(finite), len(values) - len(finite))
    assert (found.min, found.max) == (finite[0], finite[-1])
    assert found.mean == pytest.approx(finite.mean(), rel=1e-13, abs=1e-12)
    assert found.deviation == pytest.approx(finite.std(ddof=1), rel=1e-9)
    assert found.quantiles == {p: finite[p * (len(finite) - 1) // 100] for p in PERCENT}
    assert found.median == found.quantiles[50]


def test_a_summary_of_arrays_is_that_of_numpy():
    points = points_of(5000)
    found = ps.summary(points)
    assert found.points == 5000 and found.histograms == {}
    assert list(found.attributes)[:3] == ["x", "y", "z"]
    for axis, name in enumerate("xyz"):
        expect(found.attributes[name], points["xyz"][:, axis])
    for name in ("classification", "value"):
        expect(found.attributes[name], points[name])
    for component in range(3):
        expect(found.attributes[f"color_{component}"], points["color"][:, component])
    whole, real = found.attributes["classification"], found.attributes["z"]
    assert type(whole.max) is int and type(whole.median) is int and type(real.max) is float


def test_a_summary_by_an_attribute_is_that_of_its_points():
    points = points_of(3000)
    found = ps.summary(points, by="classification", keep=["value", "xyz"])
    assert isinstance(found, ps.GroupedSummary) and found.by == "classification"
    assert list(found) == [2, 5, 6] and len(found) == 3
    for value, group in found.items():
        mine = points["classification"] == value
        assert group.points == found.points[value] == mine.sum()
        assert list(group.attributes) == ["x", "y", "z", "value"]
        expect(group.attributes["value"], points["value"][mine])
        expect(group.attributes["z"], points["xyz"][mine, 2])
    colors = ps.summary(points, keep="color", histogram="color")
    assert list(colors.attributes) == list(colors.histograms) == ["color_0", "color_1", "color_2"]
    counts = ps.summary(points, by="classification", keep=[])
    assert counts.points == found.points and counts[2].attributes == {}


def test_histograms_count_what_lies_between_their_edges():
    points = points_of(2000)
    found = ps.summary(points, keep=[], histogram=["value", "z"], bins=50).histograms
    for name, values in (("value", points["value"]), ("z", points["xyz"][:, 2])):
        edges, counts = found[name]
        assert edges.dtype == np.float64 and counts.dtype == np.int64 and len(edges) == len(counts) + 1 <= 51
        finite = values[np.isfinite(values)]
        assert counts.tolist() == [int(((lo <= finite) & (finite < hi)).sum()) for lo, hi in zip(edges, edges[1:])]
    groups = ps.summary(points, by="classification", keep=[], histogram="value", bins=50)
    assert np.array_equal(sum(group.histograms["value"].counts for group in groups.values()), found["value"].counts)


def test_files_and_the_tool_give_the_same(tmp_path, tool):
    points = points_of(3000)
    del points["value"]
    half = {name: values[1000:] for name, values in points.items()}
    rest = {name: values[:1000] for name, values in points.items()}
    ps.write(tmp_path / "a.laz", half)
    ps.write(tmp_path / "b.laz", rest)
    ps.write(tmp_path / "whole.laz", points)
    apart = ps.open([tmp_path / "a.laz", tmp_path / "b.laz"]).summary(by="classification", histogram="z")
    whole = ps.open(tmp_path / "whole.laz").summary(by="classification", histogram="z")
    assert repr(apart) == repr(whole)
    for value in whole:
        assert apart[value].attributes == whole[value].attributes
    command = [tool, "info", "--json", "--stats", "--by", "classification", "--histogram", "z", tmp_path / "whole.laz"]
    told = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)["statistics"]
    assert told["points"] == 3000 and told["percent"] == list(PERCENT)
    for group in told["groups"]:
        mine = whole[group["value"]]
        assert mine.points == group["points"]
        for a in group["attributes"]:
            found = mine.attributes[a["name"]]
            assert [found.count, found.nonfinite, found.min, found.max, found.mean, found.deviation] == [
                a[key] for key in ("count", "nonfinite", "min", "max", "mean", "deviation")
            ]
            assert list(found.quantiles.values()) == a["quantiles"]
        assert mine.histograms["z"].counts.tolist() == group["histograms"][0]["counts"]


def test_whole_numbers_of_64_bits_are_kept():
    number = np.array([2**63 - 1, 2**53 + 1, 2**53, -(2**63)], np.int64)
    key = np.array([2**64 - 1, 2**64 - 2, 2**53 + 1, 0], np.uint64)
    points = {"xyz": np.zeros((4, 3)), "number": number, "key": key}
    found = ps.summary(points).attributes
    assert (found["number"].min, found["number"].max) == (-(2**63), 2**63 - 1)
    assert found["number"].quantiles[50] == 2**53 and found["number"].quantiles[75] == 2**53 + 1
    assert found["key"].max == 2**64 - 1 and found["key"].quantiles[75] == 2**64 - 2
    assert list(ps.summary(points, by="key", keep=[])) == [0, 2**53 + 1, 2**64 - 2, 2**64 - 1]
    assert list(ps.summary(points, by="number", keep=[])) == sorted(number.tolist())


def test_no_values_are_nan():
    empty = ps.summary({"xyz": np.empty((0, 3)), "label": np.empty(0, np.int32)}, histogram="label")
    label = empty.attributes["label"]
    assert empty.points == label.count == 0
    assert all(math.isnan(v) for v in (label.min, label.max, label.mean, label.deviation, label.median))
    assert empty.histograms["label"].edges.shape == empty.histograms["label"].counts.shape == (0,)
    assert len(ps.summary({"xyz": np.empty((0, 3)), "label": np.empty(0, np.int32)}, by="label")) == 0
    one = ps.summary({"xyz": np.ones((1, 3))}).attributes["x"]
    assert one.median == 1 and math.isnan(one.deviation)


def test_a_summary_is_shown_and_becomes_a_table():
    pandas = pytest.importorskip("pandas")
    points = points_of(1000)
    found, groups = ps.summary(points), ps.summary(points, by="classification")
    assert "1,000" in repr(found) and "classification" in found._repr_html_()
    assert "2: " in repr(groups) and "mean z" in groups._repr_html_()
    table = found.to_pandas()
    assert list(table.columns) == ["count", "nonfinite", "min", *(f"{p}%" for p in PERCENT), "max", "mean", "deviation"]
    expected = pandas.DataFrame(points["xyz"]).describe().loc["std"]
    assert table.loc[["x", "y", "z"], "deviation"].to_numpy() == pytest.approx(expected.to_numpy())
    by = groups.to_pandas()
    assert by.index.name == "classification" and by.loc[5, "points"] == groups[5].points
    assert by.loc[5, "z_50%"] == groups[5].attributes["z"].median


def test_what_cannot_be_summarized_is_refused():
    points = points_of(10)
    many = {"xyz": np.zeros((10_001, 3)), "id": np.arange(10_001)}
    for wrong, sentence in (
        ({"by": "z"}, "^by: 'z' has the value 3"),
        ({"by": "nothing"}, "^by: the points have no attribute 'nothing'"),
        ({"by": "value"}, "^by: 'value' has the value"),
        ({"by": ["classification", "value"]}, "^by: name one attribute"),
        ({"keep": "nothing"}, "^keep: the points have no attribute"),
        ({"histogram": "nothing"}, "^histogram: the points have no attribute"),
        ({"histogram": "z", "bins": 1}, "^bins: 1 is not from 2 to 1000"),
    ):
        with pytest.raises(ps.UsageError, match=sentence):
            ps.summary(points, **wrong)
    with pytest.raises(ps.UsageError, match="more than 10000 values"):
        ps.summary(many, by="id", keep=[])
    with pytest.raises(ps.Error, match="nothing.laz"):
        ps.summary("nothing.laz")


def test_a_summary_reports_progress_and_can_be_ended(tmp_path):
    seen = []

    def stop(*step):
        seen.append(step)
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ps.summary(points_of(1000), progress=stop)
    assert seen[0][:3] == ("reading", 1000, 1000)
