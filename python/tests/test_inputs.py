# SPDX-License-Identifier: MIT
"""Points of other libraries, tables and blocks, and results as tables."""

import os

import numpy as np
import pytest

import pointsweep as ps

CHAIN = "knn(k=8) | normals"


@pytest.fixture(scope="module")
def expected(surface):
    return ps.normals(surface, 8)


@pytest.fixture
def weights(surface):
    return np.arange(len(surface), dtype=np.uint16)


def weight_of(t):
    """Checks that the kept rows have their own values of the attribute."""
    assert np.array_equal(t["weight"], t["row"]) and 0 < len(t["row"]) < 3000


KEPT = CHAIN + " | where(weight >= 100)"


def test_structured_arrays(surface, weights, expected):
    rows = np.zeros(3000, [("x", "f8"), ("y", "f8"), ("z", "f8"), ("weight", "u2")])
    for i, axis in enumerate("xyz"):
        rows[axis] = surface[:, i]
    rows["weight"] = weights
    assert ps.normals(rows, 8).tobytes() == expected.tobytes()
    weight_of(ps.run(rows, KEPT))


def test_data_frames(surface, weights, expected):
    pandas = pytest.importorskip("pandas")
    frame = pandas.DataFrame({"x": surface[:, 0], "y": surface[:, 1], "z": surface[:, 2], "weight": weights})
    assert ps.normals(frame, 8).tobytes() == expected.tobytes()
    weight_of(ps.run(frame, KEPT))
    frame["class"] = "ground"
    with pytest.raises(ps.UsageError, match=r"class: is a column of .*drop"):
        ps.normals(frame)
    frame["class"] = pandas.array([None] + [1] * 2999, dtype="Int64")
    t = ps.run(frame, "where(class == 1)")
    assert len(t["row"]) == 2999


def test_arrow_tables(surface, weights, expected):
    pyarrow = pytest.importorskip("pyarrow")
    columns = {"x": surface[:, 0], "y": surface[:, 1], "z": surface[:, 2], "weight": weights}
    table = pyarrow.table({name: np.ascontiguousarray(values) for name, values in columns.items()})
    parts = pyarrow.concat_tables([table.slice(0, 1000), table.slice(1000)])
    for points in (table, parts, table.to_batches()[0]):
        assert ps.normals(points, 8).tobytes() == expected.tobytes()
    weight_of(ps.run(parts, KEPT))
    lists = pyarrow.FixedSizeListArray.from_arrays(pyarrow.array(surface.ravel()), 3)
    assert ps.normals(pyarrow.table({"xyz": lists}), 8).tobytes() == expected.tobytes()
    with pytest.raises(ps.UsageError, match="name: is a column of string"):
        ps.normals(table.append_column("name", pyarrow.array(["a"] * 3000)))


def test_laspy(surface, tmp_path):
    laspy = pytest.importorskip("laspy")
    for point_format in (3, 6):
        path = tmp_path / f"{point_format}.las"
        las = laspy.create(point_format=point_format, file_version="1.4")
        las.header.scales, las.header.offsets = [0.001] * 3, [431000, 5410000, 0]
        las.x, las.y, las.z = surface.T
        las.classification = np.arange(3000) % 5
        las.intensity = np.arange(3000)
        angle = "scan_angle" if point_format == 6 else "scan_angle_rank"
        las[angle] = np.arange(3000) % 90
        las.write(path)
        read = laspy.read(path)
        ours, theirs = ps.run(path, "where(classification == 2)"), ps.run(read, "where(classification == 2)")
        assert set(theirs) - {"row"} == set(ours)
        for name in ours:
            assert np.array_equal(ours[name], theirs[name]), name
        assert ps.normals(read, 8).tobytes() == ps.normals(path, 8).tobytes()


class LegacyCloud:
    """As open3d.geometry.PointCloud: vectors that NumPy reads."""

    def __init__(self, xyz, colors=None):
        self.points, self.colors = xyz, colors

    def has_normals(self):
        return False

    def has_colors(self):
        return self.colors is not None


class Tensor:
    """As open3d.core.Tensor: DLPack and nothing else."""

    def __init__(self, array, device=(1, 0)):
        self._array, self._device = array, device

    def __dlpack__(self, **options):
        return self._array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self._device


class TensorCloud:
    """As open3d.t.geometry.PointCloud."""

    def __init__(self, **attributes):
        self.point = attributes


def test_open3d_clouds_are_known_by_what_they_have(surface, expected):
    assert ps.normals(LegacyCloud(surface), 8).tobytes() == expected.tobytes()
    t = ps.run(LegacyCloud(surface, colors=surface / 1e7), "where(colors_0 > 0.0431)")
    assert t["colors"].shape[1] == 3
    cloud = TensorCloud(positions=Tensor(surface), weight=Tensor(np.arange(3000.0)[:, np.newaxis]))
    assert ps.normals(cloud, 8).tobytes() == expected.tobytes()
    weight_of(ps.run(cloud, KEPT))


def test_open3d_itself(surface, expected):
    open3d = pytest.importorskip("open3d")
    cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(surface))
    assert ps.normals(cloud, 8).tobytes() == expected.tobytes()
    tensors = open3d.t.geometry.PointCloud(open3d.core.Tensor(surface))
    assert ps.normals(tensors, 8).tobytes() == expected.tobytes()


def test_dlpack(surface, expected):
    assert ps.normals(Tensor(surface), 8).tobytes() == expected.tobytes()
    with pytest.raises(ps.UsageError, match="on another device.*copy it to the CPU"):
        ps.normals(Tensor(surface, device=(2, 0)))


def test_an_iterator_of_blocks_is_spilled(surface, weights, expected, tmp_path):
    def blocks(rows=700, **more):
        for first in range(0, 3000, rows):
            part = slice(first, first + rows)
            yield {"xyz": surface[part], "weight": weights[part], **more}

    assert ps.normals(blocks(), 8).tobytes() == expected.tobytes()
    assert ps.normals((surface[i : i + 1] for i in range(3000)), 8).tobytes() == expected.tobytes()
    weight_of(ps.run(blocks(), KEPT, temp_folder=tmp_path))
    assert os.listdir(tmp_path) == []
    with pytest.raises(ps.UsageError, match="no block"):
        ps.normals(iter([]))
    with pytest.raises(ps.UsageError, match="block 1 has xyz, but the first one has xyz, weight"):
        ps.normals(iter([{"xyz": surface, "weight": weights}, surface]))
    with pytest.raises(ps.UsageError, match="float64, which the float32"):
        ps.normals(iter([surface.astype("f4"), surface]))
    with pytest.raises(ps.UsageError, match="transpose"):
        ps.normals(iter([surface.T]))
    with pytest.raises(ps.UsageError, match="'weight' has 3 rows"):
        ps.normals(iter([{"xyz": surface, "weight": [1, 2, 3]}]))
    with pytest.raises(ps.Error, match="temp_folder"):
        ps.normals(blocks(), temp_folder=tmp_path / "nowhere")

    def breaks():
        yield surface
        raise KeyError("the source")

    with pytest.raises(KeyError, match="the source"):
        ps.normals(breaks())


def test_results_become_tables(surface):
    t = ps.run(surface, "knn(k=8) | normals | sor", keep=["xyz", "normal", "outlier"])
    names = ["x", "y", "z", "nx", "ny", "nz", "outlier"]
    rows = t.to_structured()
    assert rows.dtype.names == tuple(names) and rows["outlier"].dtype == np.uint8
    assert np.array_equal(rows["ny"], t["normal"][:, 1])
    assert ps.normals(rows, 8).tobytes() == t["normal"].tobytes()
    pandas = pytest.importorskip("pandas")
    frame = t.to_pandas()
    assert isinstance(frame, pandas.DataFrame) and list(frame.columns) == names and frame["nx"].dtype == np.float32
    pyarrow = pytest.importorskip("pyarrow")
    table = t.to_arrow()
    assert isinstance(table, pyarrow.Table) and table.column_names == names
    assert np.array_equal(table["z"].to_numpy(), surface[:, 2])


def test_components_have_the_names_of_files(surface):
    t = ps.run(surface, "knn(k=8) | normals | curvature", keep=["k1_direction", "k1"])
    assert list(t.columns()) == ["k1_x", "k1_y", "k1_z", "k1"]
    assert list(ps.generate("sphere", 10).columns()) == ["x", "y", "z", "nx", "ny", "nz"]


def test_a_budget_that_is_too_small_says_what_would_do(surface):
    with pytest.raises(ps.Error, match="give memory='[0-9]+M' or more"):
        ps.run(surface, CHAIN, memory="1M")


def test_outputs_that_cannot_be_written_are_refused(surface, tmp_path):
    with pytest.raises(ps.Error, match="nowhere"):
        ps.run(surface, CHAIN, to=tmp_path / "nowhere" / "out.ply")
    with pytest.raises(ps.Error, match="version"):
        ps.run(surface, CHAIN, to="/proc/version", overwrite=True)


def test_conditions_read_the_number_of_the_row(surface):
    numbers = np.arange(len(surface), dtype=np.uint32)
    result = ps.run({"xyz": surface, "number": numbers}, ps.head(300) | "where(row >= 200)", keep=["number"])
    assert np.array_equal(result["number"], numbers[200:300])
    with pytest.raises(ps.Error, match="an attribute is called 'row of the input'"):
        ps.run({"xyz": surface, "row of the input": numbers}, "where(row < 3)")


def test_tables_of_results_are_given_back_without_their_row_numbers(surface, tmp_path):
    pandas, _ = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    pytest.importorskip("geopandas")
    t = ps.run(surface, "where(x > 431005)")
    tables = [t.to_pandas(), t.to_pandas().query("x > 431005"), t.to_arrow(), t.to_arrow().to_batches()[0], t.to_geopandas()]
    for table in tables:
        again = ps.run(table, "where(x > 431006)")
        assert np.array_equal(again["row"], np.flatnonzero(t["xyz"][:, 0] > 431006)), type(table)
    ps.write(tmp_path / "a.laz", t.to_pandas())
    assert "row" not in ps.open(tmp_path / "a.laz").attributes
    own = pandas.DataFrame({"x": [1.0], "y": [2.0], "z": [3.0], "row": [4]})
    for points in (own, t.to_structured()):
        with pytest.raises(ps.UsageError, match="'row' is what results call the numbers of input rows; leave it out, or"):
            ps.run(points, "where(x > 0)")


def test_tables_of_which_two_columns_have_one_name_are_refused(surface):
    pandas, pyarrow = pytest.importorskip("pandas"), pytest.importorskip("pyarrow")
    frame = pandas.DataFrame(surface, columns=list("xyz"))
    for table in (pandas.concat([frame, frame[["x"]]], axis=1), pyarrow.table([surface[:, 0]] * 4, names=["x", "y", "z", "x"])):
        with pytest.raises(ps.UsageError, match="the table has two columns called 'x'; rename"):
            ps.normals(table)


def test_data_frames_of_dask_say_how_they_are_given(surface, expected):
    dask, pandas = pytest.importorskip("dask.dataframe"), pytest.importorskip("pandas")
    frame = dask.from_pandas(pandas.DataFrame(surface, columns=list("xyz")), npartitions=3)
    with pytest.raises(ps.UsageError, match=r"give frame.compute\(\), or \(p.compute\(\) for p in frame.partitions\)"):
        ps.normals(frame, 8)
    assert ps.normals((p.compute() for p in frame.partitions), 8).tobytes() == expected.tobytes()


def test_points_of_laspy_keep_their_grid_in_las(tmp_path):
    laspy = pytest.importorskip("laspy")
    header = laspy.LasHeader(point_format=6, version="1.4")
    header.scales, header.offsets = [0.001, 0.001, 0.01], [500000.0005, 5400000, 100]
    las = laspy.LasData(header)
    integers = np.random.default_rng(2).integers(-50000, 50000, (3, 500))
    las.X, las.Y, las.Z = integers
    las.write(tmp_path / "in.las")

    def grid_of(name):
        read = laspy.read(tmp_path / name)
        same = np.array_equal([read.X, read.Y, read.Z], integers)
        return list(read.header.scales), list(read.header.offsets), same

    grid = (list(header.scales), list(header.offsets), True)
    arrays = ps.read(tmp_path / "in.las")
    for points in (las, laspy.read(tmp_path / "in.las"), arrays, arrays.copy(), ps.chunks(tmp_path / "in.las", 200), iter([arrays])):
        ps.write(tmp_path / "out.las", points, overwrite=True)
        assert grid_of("out.las") == grid, type(points)
    with laspy.open(tmp_path / "in.las") as reader:
        ps.write(tmp_path / "out.las", reader, overwrite=True)
    assert grid_of("out.las") == grid
    with pytest.warns(ps.PointsweepWarning, match="rounded"):
        ps.write(tmp_path / "coarse.las", las, scale=0.1)
    assert grid_of("coarse.las")[0] == [0.1] * 3
    moved = ps.read(tmp_path / "in.las")
    moved["xyz"] = moved["xyz"] / 3  # no longer on the grid
    ps.write(tmp_path / "moved.las", moved)
    np.testing.assert_allclose(ps.read(tmp_path / "moved.las")["xyz"], moved["xyz"], rtol=0, atol=1e-6)
    ps.write(tmp_path / "out.ply", las)
    assert np.array_equal(ps.read(tmp_path / "out.ply")["xyz"], arrays["xyz"])
