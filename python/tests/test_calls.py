# SPDX-License-Identifier: MIT
"""Stages, operators and pipelines called on points: the same as `run` with them."""

import inspect
import typing

import numpy as np
import pytest
from conftest import made_by

import pointsweep as ps
from pointsweep import _core
from pointsweep._adapters import are_points
from pointsweep._options import OPTIONS_OF_FILES, run_options
from pointsweep._types import RunOptions

#: values of required options for which the samples of the declarations do not fit these clouds
OPTIONS = {
    "where": {"condition": "x > 0.5"}, "assign": {"assign": "a = 1"}, "drop": {"attributes": ["a"]}, "voxel": {"size": 0.2},
    "poisson": {"radius": 0.1}, "color": {"by": "a"}, "decimate": {"share": 0.5}, "head": {"number": 100}, "crop": {"bounds": [0, 0, 1, 1]}, "dbscan": {"eps": 0.2, "radius": 0.2},
    "statistics": {"of": ["a_median", "z_range"], "where": "a > 1"}, "transform": {"scale": 2},
    "take": {"attributes": ["a", "classification"]},
}  # fmt: skip
#: stages that compute nothing, or read attributes that only other stages make
REFUSED = {"fair", "knn", "reneighbor", "resort", "simplify"}


@pytest.fixture(scope="module")
def cloud():
    """500 points of a plane with its normals and an attribute that stages read."""
    xyz = np.random.default_rng(3).random((500, 3)) * [1, 1, 0.01]
    normal = np.tile(np.float32([0, 0, 1]), (500, 1))
    return {"xyz": xyz, "normal": normal, "a": np.arange(500, dtype=np.float32), "classification": np.full(500, 2, np.uint8)}


def as_file(points, folder):
    ps.run(points, "decimate(1)", to=folder / "points.ply", overwrite=True)
    return ps.open(folder / "points.ply")


def as_las(points, folder):
    laspy = pytest.importorskip("laspy")
    las = laspy.create(point_format=6)
    las.x, las.y, las.z = points["xyz"].T
    las.classification = points["classification"]
    for name, values in (("nx", points["normal"][:, 0]), ("ny", points["normal"][:, 1]), ("nz", points["normal"][:, 2]), ("a", points["a"])):
        las.add_extra_dim(laspy.ExtraBytesParams(name, values.dtype))
        las[name] = values
    return las


def with_nan(points, folder):
    xyz = points["xyz"].copy()
    xyz[7], xyz[70, 1] = np.nan, np.inf
    return {**points, "xyz": xyz}


KINDS = {
    "arrays": lambda points, folder: points,
    "file": as_file,
    "path": lambda points, folder: as_file(points, folder).files[0],
    "laspy": as_las,
    "empty": lambda points, folder: {name: values[:0] for name, values in points.items()},
    "nan": with_nan,
}


def result_or_sentence(call):
    """The bytes of the arrays, or the sentence of the error."""
    try:
        return {name: values.tobytes() for name, values in call().items()}
    except ps.Error as error:
        return str(error)


@pytest.mark.filterwarnings("ignore::pointsweep.PointsweepWarning")
@pytest.mark.parametrize("kind", KINDS)
def test_every_stage_is_called_on_points(declarations, cloud, kind, tmp_path):
    ps.run(cloud, "decimate(1)", to=tmp_path / "other.ply")
    refused = set()
    for operator in declarations:
        make, options, _ = made_by(operator)
        options.update(OPTIONS.get(make.__name__, {}))
        options.update({name: tmp_path / "other.ply" for name, value in options.items() if value == "other.ply"})
        stage = make(**options)
        points = KINDS[kind](cloud, tmp_path)
        called = result_or_sentence(lambda: stage(points, threads=1))
        assert called == result_or_sentence(lambda: ps.run(points, str(stage), threads=1)), stage
        if isinstance(called, str):
            refused.add(operator["name"])
        with pytest.raises(ps.UsageError, match=rf"pointsweep\.{make.__name__}\(\.\.\.\)\(points\)"):
            make(cloud["xyz"])
        with pytest.raises(ps.UsageError, match=rf"pointsweep\.{make.__name__}\(\.\.\.\)\(points\)"):
            make(cloud)
    assert refused == ({operator["name"] for operator in declarations} if kind == "empty" else REFUSED)


def test_pipelines_and_operators_are_called_on_points(cloud, tmp_path):
    @ps.operator(makes={"high": "u1"}, neighbors=False)
    def high(p):
        return (p.xyz[:, 2] > 0.005).astype("u1")

    @ps.select()
    def right(p):
        return p.xyz[:, 0] > 0.5

    xyz = cloud["xyz"]
    planarity = (ps.knn(16) | ps.features())(xyz, memory="2G")["planarity"]
    assert planarity.tobytes() == ps.run(xyz, "knn(k=16) | features")["planarity"].tobytes()
    assert high(xyz)["high"].tobytes() == (xyz[:, 2] > 0.005).astype("u1").tobytes()
    assert list(right(xyz)["row"]) == list(np.flatnonzero(xyz[:, 0] > 0.5))
    report = (ps.knn(8) | ps.normals() | high)(xyz, to=tmp_path / "out.ply", keep=["normal", "high"])
    assert report.points_written == 500 and "high" in ps.open(tmp_path / "out.ply").attributes
    into = np.empty((500, 3), np.float32)
    ps.normals()(xyz, out={"normal": into})
    assert into.tobytes() == ps.normals(xyz).tobytes()


def test_a_stage_names_its_neighbourhood(cloud):
    xyz = cloud["xyz"]
    assert str(ps.features(k=16)) == "knn(k=16) | features" and str(ps.normals(k=9, radius=0.5)) == "knn(k=9, radius=0.5) | normals"
    assert ps.features(k=16)(xyz)["planarity"].tobytes() == (ps.knn(16) | ps.features())(xyz)["planarity"].tobytes()
    assert ps.normals(k=9)(xyz)["normal"].tobytes() == ps.normals(xyz, 9).tobytes() != ps.normals(xyz).tobytes()
    assert ps.features(k=16) | ps.normals() == ps.knn(16) | ps.features() | ps.normals() != ps.features() | ps.normals()
    with pytest.raises(ps.UsageError, match="knn comes once and first"):
        (ps.knn(8) | ps.features(k=16))(xyz)
    with pytest.raises(ps.UsageError, match="features: k: 'many'"):
        ps.features(k="many")


@pytest.mark.parametrize(
    "function", [ps.run, ps.plan, ps.chunks, ps.normals, ps.neighbors, ps.Cloud.run, ps.Cloud.chunks, ps.Stage.__call__, ps.Operator.__call__]
)
def test_signatures_name_every_option(function):
    parameters = inspect.signature(function).parameters
    assert not [p for p in parameters.values() if p.kind is p.VAR_KEYWORD]
    assert {"memory", "threads", "nonfinite", "axis", "positions", "provenance"} <= set(parameters)


def test_every_option_of_runs_is_declared_typed_and_documented():
    of_the_tool = {"engine", "no_provenance"}  # the package has provenance=False instead of no_provenance
    assert set(_core.run_options) - of_the_tool == set(RunOptions.__annotations__) - {"ignore_crs"}
    for name in RunOptions.__annotations__:
        assert f"    {name} : " in ps.run.__doc__, name
    of_arrays = {"axis", "order", "positions", "replace", "threads", "memory", "temp_folder", "nonfinite", "overwrite", "ignore_crs"}
    assert set(RunOptions.__annotations__) == of_arrays | set(OPTIONS_OF_FILES)


def test_points_are_told_from_options():
    for points in (np.zeros((0, 3)), [[0, 0, 0]], {"xyz": 1}, iter([]), np.zeros(2, [("x", "f4")])):
        assert are_points(points)
    for option in (3, 0.5, "normal", ["a", "b"], (1, 2, 3), np.zeros(4), np.float32(3), None, True):
        assert not are_points(option)


def test_positions_and_provenance(cloud, tmp_path):
    assert ps.run(cloud["xyz"], "where(x > 0.5)", positions="float32")["xyz"].dtype == np.float32
    written = tmp_path / "out.ply"
    for provenance, holds in ((True, True), ("names", True), (False, False)):
        ps.run(cloud["xyz"], "normals", to=written, provenance=provenance, overwrite=True)
        assert (b"normals" in written.read_bytes()[:1500]) == holds
    ps.run(cloud["xyz"], "decimate(1)", to=written, overwrite=True)
    ps.run(written, "normals", to=tmp_path / "paths.ply", provenance="paths")
    assert str(written).encode() in (tmp_path / "paths.ply").read_bytes()[:2000]
    with pytest.raises(ps.UsageError, match="provenance: 'all' is not one of names, paths"):
        ps.run(written, "normals", to=written, provenance="all")
    for wrong in ({"provenance": False}, {"prefix": "p"}):
        with pytest.raises(ps.UsageError, match="is for outputs in files"):
            ps.run(cloud["xyz"], "normals", **wrong)
    with pytest.raises(ps.UsageError, match="positions: 'f4'"):
        ps.run(cloud["xyz"], "normals", positions="f4")


def test_the_words_of_options_are_those_of_the_declarations():
    hints = typing.get_type_hints(RunOptions)
    for name, (_, words, _) in _core.run_options.items():
        if not words or name in ("engine", "point_format"):  # an option of the tool alone, and one whose words are numbers
            continue
        literals = [value for part in (hints[name], *typing.get_args(hints[name])) for value in typing.get_args(part)]
        assert [value for value in literals if isinstance(value, str)] == words, name
        for word in words:
            assert run_options(**{name: word})[name] == word
        with pytest.raises(ps.UsageError, match=f"{name}: 'other' is not one of {', '.join(words)}"):
            run_options(**{name: "other"})
