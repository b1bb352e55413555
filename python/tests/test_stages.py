# SPDX-License-Identifier: MIT
"""Pipelines as objects, made of the declarations of the operators."""

import builtins
import inspect
import json
import keyword
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import pointsweep as ps

PYTHON = Path(__file__).resolve().parents[1]


def test_the_functions_are_those_of_the_declarations(declarations):
    command = [sys.executable, PYTHON / "make_stages.py"]
    made = subprocess.run(command, input=json.dumps(declarations), check=True, capture_output=True, text=True).stdout
    assert (PYTHON / "pointsweep/_stages.py").read_text() == made, "run script/docs"


def test_every_operator_is_a_function_that_says_what_it_is(declarations):
    for operator in declarations:
        function = getattr(ps, operator["name"])
        for text in (operator["formula"].splitlines() or [""])[:1] + [m["name"] for m in operator["makes"]]:
            assert " ".join(text.split()) in " ".join(function.__doc__.split()), operator["name"]
        options = {o["name"] + "_" * keyword.iskeyword(o["name"]) for o in operator["options"]}
        assert options <= set(inspect.signature(function).parameters)


def test_help_on_normals_has_formula_and_source():
    text = inspect.getdoc(ps.normals)
    for part in ("Parameters", "eigenvector of the smallest eigenvalue", "Pajarola", "190 cycles", "(n, 3) float32"):
        assert part in text


def test_stages_are_texts():
    assert str(ps.knn(16)) == "knn(k=16)" and str(ps.knn()) == "knn" and str(ps.normals()) == "normals"
    assert str(ps.knn(radius=0.5)) == "knn(radius=0.5)"
    assert str(ps.normals(orient="up")) == "normals(orient=up)"
    assert str(ps.normals(viewpoint=(1, 2, 3.5))) == "normals(orient=viewpoint, viewpoint=[1.0,2.0,3.5])"
    assert str(ps.features(["planarity", "linearity"])) == "features(names=[planarity,linearity])"
    assert str(ps.where("z > 1 && nx < 2")) == 'where(condition="z > 1 && nx < 2")'
    assert str(ps.drop(["intensity", "gps_time"])) == "drop(attributes=[intensity,gps_time])"
    assert str(ps.assign("a = 1 where z > 2", as_="uint8")) == 'set(assign="a = 1 where z > 2", as=uint8)'
    assert str(ps.crop([0, 0, 2.5, 1], outside=True)) == "crop(bounds=[0.0,0.0,2.5,1.0], outside=true)"
    assert str(ps.features(with_point=False)) == "features(with_point=no)" and str(ps.ground(noise=False)) == "ground"
    assert str(ps.crop(polygon=PYTHON / "a b.geojson")).endswith('a b.geojson")')
    assert str(ps.height(k=3)) == "height(k=3)" and str(ps.voxel(2)) == "voxel(size=2.0)"
    assert repr(ps.knn(16) | ps.sor()) == "<pointsweep.Pipeline: knn(k=16) | sor>"


def test_pipelines_of_objects_are_those_of_texts(surface):
    @ps.operator(reads=["normal"], makes={"steep": "u1"})
    def steep(p):
        return (np.abs(p.normal[:, 2]) < 0.7).astype("u1")

    objects = ps.knn(16) | ps.normals(orient="up") | steep | ps.sor(3, definition="pcl") | ps.where("outlier == 0")
    texts = "knn(k=16) | normals(orient=up)" | steep | "sor(multiplier=3, definition=pcl) | where(outlier == 0)"
    a, b = ps.run(surface, objects), ps.run(surface, texts)
    assert set(a) == set(b) and all(a[name].tobytes() == b[name].tobytes() for name in a)
    mixed = "knn(k=16)" | ps.normals(orient="up") | [steep, ps.sor(3, definition="pcl")] | ps.where("outlier == 0")
    assert ps.run(surface, mixed)["row"].tobytes() == a["row"].tobytes()
    assert ps.run(surface, ps.knn(8) | ps.normals())["normal"].tobytes() == ps.normals(surface, 8).tobytes()
    alone = ps.run(surface, ps.normals())
    assert alone["normal"].tobytes() == ps.normals(surface, 16).tobytes()


def test_another_cloud_is_a_path_or_a_cloud(surface, tmp_path):
    other = tmp_path / "a b.ply"
    ps.run(surface + [0, 0, 0.25], ps.unique(), to=other)
    by_path = ps.run(surface, ps.distance_to(other))["cloud_distance"]
    assert ps.run(surface, ps.distance_to(ps.open(other)))["cloud_distance"].tobytes() == by_path.tobytes()
    assert 0 < by_path.max() <= 0.25 + 1e-9
    with pytest.raises(ps.UsageError, match="cloud of 2 files"):
        ps.distance_to(ps.open([other, other]))
    with pytest.raises(ps.UsageError, match="is not a path"):
        ps.distance_to(surface)


def test_an_operator_before_the_first_text(surface):
    @ps.operator(makes={"z2": "f8"}, neighbors=False)
    def z2(p):
        return p.xyz[:, 2] ** 2

    assert ps.run(surface, z2 | ps.where("z2 > 90000"))["row"].size < 3000


def test_conditions_with_names_of_any_spelling(surface):
    t = ps.run({"xyz": surface, "intensity": np.arange(3000)}, ps.where("(intensity < 10 || intensity == 20) && z > 0"))
    assert list(t["row"]) == [*range(10), 20]
    scan = {"xyz": surface, "return_number": (np.arange(3000) % 3).astype("u1")}
    for stage in (ps.where("ReturnNumber == 1"), ps.where("scalar_returnnumber == 1")):
        assert list(ps.run(scan, stage)["row"]) == list(range(1, 3000, 3))
    t = ps.run(scan, ps.assign("ReturnNumber = 5 where Return_Number == 1"))
    assert list(t["return_number"][:4]) == [0, 5, 2, 0]


@pytest.mark.parametrize(
    ("call", "sentence"),
    [
        (lambda: ps.knn("many"), "knn: k: 'many' is not a whole number"),
        (lambda: ps.voxel(float("nan")), "voxel: size: .* not finite"),
        (lambda: ps.normals(orient="down"), "orient: 'down'"),
        (lambda: ps.normals(memory="1G"), "without points it is a stage, which has no memory"),
        (lambda: ps.where(3), "not a text"),
        (lambda: ps.crop("0,0,1,1"), "a list of numbers"),
        (lambda: ps.crop([0, 0, 1, 1], outside="yes"), "neither True nor False"),
        (lambda: ps.run(np.zeros((9, 3)), ps.knn), "write knn()"),
        (lambda: ps.run(np.zeros((9, 3)), ps.sor(definition="mine")), "definition"),
    ],
)
def test_wrong_options_are_refused(call, sentence):
    with pytest.raises(ps.UsageError, match=sentence):
        call()


def test_missing_and_unknown_options_are_type_errors():
    with pytest.raises(TypeError):
        ps.voxel()
    with pytest.raises(TypeError):
        ps.knn(kk=8)


def test_no_exported_name_is_that_of_a_builtin():
    assert not set(ps.__all__) & set(dir(builtins))
    code = "import builtins; from pointsweep import *; assert open is builtins.open and set is builtins.set and knn"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_former_names_work_and_say_the_new_one(tmp_path):
    with pytest.warns(DeprecationWarning, match=r"pointsweep\.set is now called pointsweep\.assign") as noted:
        stage = ps.set("a = 1 where z > 2", as_="uint8")
    assert stage == ps.assign("a = 1 where z > 2", as_="uint8") and noted[0].filename == __file__
    assert len(ps.open(ps.generate("plane", 50, tmp_path / "a.ply").files)) == 50


def test_no_docstring_has_the_least_number(declarations):
    for name in ps._stages.__all__:
        assert "5e-324" not in getattr(ps, name).__doc__
    allowed = {option["name"]: option["allowed"] for o in declarations if o["name"] == "voxel" for option in o["options"] if "allowed" in option}
    assert allowed["size"] == "above 0" and "; above 0;" in ps.voxel.__doc__


def test_what_is_made_after_moved_points_is_returned():
    xyz = np.random.default_rng(3).random((200, 3))
    for pipeline in ("set(z = z * 3) | normals", "set(x = x + 1, y = y - 1) | normals"):
        result = ps.run(xyz, pipeline)
        assert "normal" in result and "xyz" in result, pipeline


@pytest.mark.filterwarnings("ignore:replacing nx, ny, nz of the input")
def test_transform_takes_a_matrix_as_array_or_file(tmp_path):
    random = np.random.default_rng(9)
    xyz, c = random.random((300, 3)) * 100, np.cos(0.7)
    turn = np.array([[c, -np.sin(0.7), 0, 5e5], [np.sin(0.7), c, 0, 5e6], [0, 0, 1, -12.5], [0, 0, 0, 1]])
    normal = random.normal(size=(300, 3))
    normal = (normal / np.linalg.norm(normal, axis=1)[:, None]).astype(np.float32)
    points = {"xyz": xyz, "normal": normal}
    there = ps.run(points, ps.transform(turn))
    np.testing.assert_allclose(there["xyz"], xyz @ turn[:3, :3].T + turn[:3, 3], rtol=0, atol=2e-9)
    np.testing.assert_allclose(there["normal"], normal @ turn[:3, :3].T, rtol=0, atol=1e-6)
    back = ps.run({"xyz": there["xyz"], "normal": there["normal"]}, ps.transform(turn, inverse=True))
    np.testing.assert_allclose(back["xyz"], xyz, rtol=0, atol=1e-8)
    np.testing.assert_allclose(back["normal"], normal, rtol=0, atol=1e-6)
    np.savetxt(tmp_path / "m.txt", turn, fmt="%.17g")
    for same in (turn[:3], turn.tolist(), tmp_path / "m.txt", str(tmp_path / "m.txt")):
        np.testing.assert_array_equal(ps.run(points, ps.transform(same))["xyz"], there["xyz"])
    np.testing.assert_array_equal(ps.transform(scale=2, translate=(1, 2, 3))(xyz)["xyz"], 2 * xyz + [1, 2, 3])


def test_transform_refuses_what_is_no_matrix():
    for wrong, words in [
        (np.eye(3), "matrix: ndarray is no matrix of 4 rows of 4 numbers"),
        ([1, 2, 3], "neither a matrix of 4 rows of 4 numbers nor a path"),
        (np.full((4, 4), np.nan), "is not finite"),
        (7, "is neither a matrix of 4 rows of 4 numbers nor a path"),
        (np.zeros((3, 4)), "the matrix is singular"),
        ("absent.txt", "absent.txt: cannot be opened"),
    ]:
        with pytest.raises((ps.UsageError, ps.Error), match=words):
            ps.run(np.random.default_rng(1).random((9, 3)), ps.transform(wrong))


def test_a_polygon_is_geojson_as_a_dict(surface):
    square = [[431002, 5410002], [431006, 5410002], [431006, 5410006], [431002, 5410006], [431002, 5410002]]
    polygon = {"type": "Polygon", "coordinates": [square]}
    expected = ps.crop((431002, 5410002, 431006, 5410006))(surface)["row"]
    assert 0 < len(expected) < 3000
    for shape in (polygon, {"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {}, "geometry": polygon}]}):
        assert np.array_equal(ps.crop(polygon=shape)(surface)["row"], expected)
