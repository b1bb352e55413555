# SPDX-License-Identifier: MIT
"""Point files against the command-line tool."""

import filecmp

import numpy as np
import pytest

import pointsweep as ps


@pytest.fixture
def tiles(tmp_path):
    """Two neighbouring tiles as LAS files."""
    folder = tmp_path / "tiles"
    folder.mkdir()
    random = np.random.default_rng(5)
    for i in range(2):
        xyz = random.random((2000, 3)) * [10, 10, 1] + [10 * i, 0, 0]
        intensity = random.integers(0, 1000, 2000).astype(np.uint16)
        ps.run(
            {"xyz": xyz, "intensity": intensity}, "decimate(1)", to=folder / f"tile_{i}.las"
        )
    return folder


def test_opening_reads_headers(tiles):
    cloud = ps.open(tiles / "*.las")
    assert len(cloud) == 4000 and [f[-10:] for f in cloud.files] == ["tile_0.las", "tile_1.las"]
    (x0, y0, z0), (x1, y1, z1) = cloud.bounds
    assert 0 <= x0 < 1 and 19 < x1 <= 20 and z1 <= 1.001
    assert cloud.crs is None
    assert cloud.attributes["intensity"] == np.uint16 and cloud.attributes["x"] == np.float64
    assert "2 files, 4,000 points" in repr(cloud)


def test_a_file_has_the_bytes_of_the_tool(tiles, run_tool, tmp_path):
    report = ps.open(tiles).run("knn(k=8) | normals", to=tmp_path / "mine.las", memory="256M", threads=2)
    run_tool("run", "--pipeline", "knn(k=8) | normals", "tiles/tile_0.las", "tiles/tile_1.las", "-o", "its.las")
    assert filecmp.cmp(tmp_path / "mine.las", tmp_path / "its.las", shallow=False)
    assert report.points_written == 4000 and report.statistics["k"] == 8


def test_a_folder_gets_a_file_for_each_input(tiles, run_tool, tmp_path):
    ps.open(tiles).run("knn(k=8) | normals", to=str(tmp_path / "mine") + "/")
    (tmp_path / "its").mkdir()
    run_tool("run", "--pipeline", "knn(k=8) | normals", "tiles", "-o", "its/")
    for i in range(2):
        assert filecmp.cmp(tmp_path / f"mine/tile_{i}.las", tmp_path / f"its/tile_{i}.las", shallow=False)


def test_a_name_of_a_copc_file_gives_levels(tiles, run_tool, tmp_path):
    ps.open(tiles).run("knn(k=8) | normals", to=tmp_path / "mine.copc.laz", provenance=False)
    run_tool("run", "--pipeline", "knn(k=8) | normals", "tiles", "-o", "its.copc.laz", "--no-provenance")
    assert filecmp.cmp(tmp_path / "mine.copc.laz", tmp_path / "its.copc.laz", shallow=False)
    assert (tmp_path / "mine.copc.laz").read_bytes()[377:381] == b"copc"
    ps.open(tmp_path / "mine.copc.laz").run("where(z > -1000)", to=str(tmp_path / "again") + "/")
    assert (tmp_path / "again/mine.copc.laz").read_bytes()[377:381] == b"copc"


def test_a_copc_file_is_read_by_levels(tmp_path):
    ps.generate("statue", 300_000, tmp_path / "a.copc.laz")
    sizes = [len(ps.open(tmp_path / "a.copc.laz", depth=depth)) for depth in (0, 1, 31)]
    assert 0 < sizes[0] < sizes[1] < sizes[2] == 300_000
    assert ps.info(tmp_path / "a.copc.laz", depth=0).points == sizes[0]
    assert len(ps.open(tmp_path / "a.copc.laz", resolution=0.02)) == sizes[0]
    with pytest.raises(ps.UsageError, match="depth and resolution: each says how files are read"):
        ps.open(tmp_path / "a.copc.laz", depth=1, resolution=0.1)
    ps.generate("statue", 300, tmp_path / "b.laz")
    with pytest.raises(ps.Error, match="has no levels of detail.*leave depth out"):
        ps.open(tmp_path / "b.laz", depth=1)


def test_a_folder_is_refused_for_arrays(tmp_path):
    with pytest.raises(ps.UsageError, match="is a folder"):
        ps.run(np.random.rand(9, 3), "normals", to=tmp_path)


def test_points_of_files_come_as_arrays(tiles):
    cloud = ps.open([tiles / "tile_0.las", tiles / "tile_1.las"])
    everything = cloud.run("decimate(1)")
    assert everything["xyz"].shape == (4000, 3) and everything["intensity"].dtype == np.uint16
    kept = cloud.run("knn(k=8) | normals", keep=["xyz", "normal"])
    assert kept["normal"].tobytes() == ps.normals(everything["xyz"], 8).tobytes()
    assert ps.neighbors(tiles, k=3).indices.shape == (4000, 3)


def test_a_cloud_is_an_array_of_its_positions(tiles):
    cloud = ps.open(tiles)
    xyz = np.asarray(cloud)
    assert xyz.shape == (4000, 3) and xyz.tobytes() == cloud.run("decimate(1)")["xyz"].tobytes()
    assert np.array(cloud, np.float32).dtype == np.float32
    assert ps.normals({"xyz": cloud}, 8).tobytes() == ps.normals(cloud, 8).tobytes()
    with pytest.raises(ValueError, match="copy"):
        cloud.__array__(copy=False)


def test_coordinates_in_capitals_are_positions(tmp_path):
    file = tmp_path / "capitals.csv"
    file.write_text("X,Y,Z,Intensity\n1,2,3,4\n4,5,6,7\n")
    xyz = [[1, 2, 3], [4, 5, 6]]
    assert list(ps.read(file)) == ["xyz", "Intensity"] and ps.read(file)["xyz"].tolist() == xyz
    assert np.asarray(ps.open(file)).tolist() == xyz
    assert ps.run(file, "transform(scale=2)")["xyz"].tolist() == [[2, 4, 6], [8, 10, 12]]
    assert ps.read(file, keep=["intensity"])["intensity"].tolist() == [4, 7]
    assert np.concatenate([block["xyz"] for block in ps.chunks(file, 1)]).tolist() == xyz
    assert ps.open(file).with_columns(more=[8, 9]).read()["xyz"].tolist() == xyz
    capitals = {axis: np.array(values) for axis, values in zip("XYZ", np.transpose(xyz).astype(float))}
    assert ps.run(capitals, "where(x > 2)")["xyz"].tolist() == [[4, 5, 6]]


def test_coordinates_of_different_types_are_positions_in_float64(tmp_path):
    ps.write(tmp_path / "far.las", np.array([[0, 0, 0], [1e10, 1, 1]]))
    assert ps.read(tmp_path / "far.las")["xyz"].tolist() == [[0, 0, 0], [1e10, 1, 1]]
    mixed = {"x": np.arange(3), "y": np.arange(3.0), "z": np.arange(3.0)}
    assert [block["xyz"].dtype for block in ps.chunks(mixed, 2)] == [np.float64] * 2


def test_made_coordinates_replace_those_of_las(tmp_path):
    ps.write(tmp_path / "in.las", np.arange(15.0).reshape(5, 3), scale=0.001)
    columns = ps.open(tmp_path / "in.las").with_columns(x=np.arange(5.0))
    with pytest.warns(ps.PointsweepWarning, match="replacing x of the input"):
        assert columns.run("where(x < 2)", keep="xyz")["xyz"][:, 0].tolist() == [0, 1]
    columns.write(tmp_path / "out.las")
    assert np.allclose(ps.read(tmp_path / "out.las")["xyz"][:, 0], np.arange(5), atol=1e-3)


def test_a_run_of_files_is_resumed(tiles, tmp_path):
    to, folder = tmp_path / "out.las", tmp_path / "progress"
    whole = tmp_path / "whole.las"
    cloud = ps.open(tiles)

    def stop(phase, done, total):
        if phase == "sweeping":
            raise KeyboardInterrupt

    try:
        cloud.run("knn(k=8) | normals", to=to, resume=folder, progress=stop)
    except KeyboardInterrupt:
        assert not to.exists()
    if not to.exists():
        with pytest.warns(ps.PointsweepWarning, match="Went on"):
            cloud.run("knn(k=8) | normals", to=to, resume=folder)
    cloud.run("knn(k=8) | normals", to=whole)
    assert filecmp.cmp(to, whole, shallow=False)


def test_generated_files_have_the_bytes_of_the_tool(run_tool, tmp_path):
    cloud = ps.generate("statue", 5000, tmp_path / "mine.ply", seed=3, noise=0.001)
    run_tool("generate", "statue", "its.ply", "-n", 5000, "--seed", 3, "--noise", 0.001)
    assert filecmp.cmp(tmp_path / "mine.ply", tmp_path / "its.ply", shallow=False)
    arrays = ps.generate("statue", 5000, seed=3, noise=0.001)
    assert len(cloud) == 5000 and set(arrays) == {"xyz", "normal"}
    assert ps.run(cloud, "decimate(1)")["xyz"].tobytes() == arrays["xyz"].tobytes()


def test_opening_does_not_keep_what_files_held_then(tmp_path):
    path = tmp_path / "cloud.ply"
    cloud = ps.generate("plane", 100, path)
    ps.generate("plane", 200, path, overwrite=True)
    assert cloud.run("normals").report.points == 200


def test_the_layout_of_outputs_is_stated_as_for_the_tool(tmp_path, run_tool):
    xyz = np.random.default_rng(5).uniform(0, 90, (300, 3)).round(3) + (684992, 4873411, 0)
    gps = np.arange(300) / 8
    options = dict(scale=(0.01, 0.01, 0.5), offset=[684000, 4873000, 0], point_format=1, las_version="1.2")
    with pytest.warns(ps.PointsweepWarning, match="rounded to steps of 0.01 in x, 0.01 in y and 0.5 in z"):
        ps.run({"xyz": xyz, "gps_time": gps}, "decimate(1)", to=tmp_path / "a.las", **options)
    back = ps.run(tmp_path / "a.las", "decimate(1)", keep=["xyz", "gps_time"])
    assert (np.abs(back["xyz"] - xyz).max(axis=0) <= np.array([0.005, 0.005, 0.25]) + 1e-6).all()
    assert (back["gps_time"] == gps).all()
    ps.run(tmp_path / "a.las", "normals", to=tmp_path / "b.laz", scale=0.001, offset="auto", point_format=6, overwrite=True)
    run_tool("normals", tmp_path / "a.las", tmp_path / "c.laz", "--scale", "0.001", "--offset", "auto", "--point-format", "6")
    assert (tmp_path / "b.laz").read_bytes() == (tmp_path / "c.laz").read_bytes()
    ps.run(tmp_path / "a.las", "decimate(1)", to=tmp_path / "a.csv", decimals=3, keep=["x", "y", "z"])
    assert len((tmp_path / "a.csv").read_text().splitlines()[1].split(",")[0].split(".")[1]) == 3
    for wrong in ({"scale": 0}, {"scale": "x"}, {"scale": [1, 2]}, {"offset": 3}, {"point_format": 12}, {"las_version": "2"}, {"decimals": -1}):
        with pytest.raises(ps.UsageError, match=next(iter(wrong))):
            ps.run(xyz, "normals", to=tmp_path / "d.las", **wrong)
    with pytest.raises(ps.UsageError, match="scale: is for outputs in files"):
        ps.run(xyz, "normals", scale=0.1)
    with pytest.raises(ps.UsageError, match="is for LAS, LAZ, COPC outputs"):
        ps.run(xyz, "normals", to=tmp_path / "d.ply", scale=0.1)


def test_points_go_to_files_and_back_as_they_are(tmp_path):
    xyz = np.random.default_rng(1).random((1000, 3)).round(3)
    given = {"xyz": xyz, "intensity": np.arange(1000, dtype="u2"), "label": np.arange(1000, dtype="i4")}
    report = ps.write(tmp_path / "a.ply", given, crs=2154)
    assert report.statistics["points_written"] == 1000
    read = ps.read(tmp_path / "a.ply")
    assert list(read) == ["xyz", "intensity", "label"]
    for name, values in given.items():
        assert np.array_equal(read[name], values) and read[name].dtype == values.dtype, name
    assert list(ps.read(tmp_path / "a.ply", keep="label")) == ["label"]

    cloud = ps.open(tmp_path / "a.ply")
    assert np.array_equal(np.asarray(cloud), xyz)
    cloud.write(tmp_path / "b.laz", scale=0.001, threads=1)
    assert np.allclose(ps.read(tmp_path / "b.laz")["xyz"], xyz, rtol=0, atol=0.0005)
    assert str(ps.open(tmp_path / "b.laz").crs) == str(cloud.crs)
    with pytest.raises(ps.Error, match="exists"):
        cloud.write(tmp_path / "b.laz")

    ps.write(tmp_path / "c.csv", xyz)
    assert np.array_equal(ps.read(tmp_path / "c.csv")["xyz"], xyz)
    sweep = ps.read(tmp_path / "a.ply", order="sweep", axis="x")
    assert np.array_equal(sweep["intensity"], np.argsort(xyz[:, 0], kind="stable")) or np.all(np.diff(sweep["xyz"][:, 0]) >= 0)


def test_layouts_are_taken_from_arrays_and_numbers_of_numpy(tmp_path):
    xyz = np.random.default_rng(2).random((100, 3))
    with pytest.warns(ps.PointsweepWarning, match="rounded to steps of 0.01, 0.01, 0.01|rounded to steps of 0.01"):
        ps.write(tmp_path / "a.las", xyz, scale=np.array([0.01] * 3), offset=np.zeros(3), point_format=np.int64(7))
    with pytest.warns(ps.PointsweepWarning, match="rounded"):
        ps.write(tmp_path / "b.las", xyz, scale=np.array(0.01), offset=np.zeros(3), point_format=7)
    assert np.array_equal(ps.read(tmp_path / "a.las")["xyz"], ps.read(tmp_path / "b.las")["xyz"])
    ps.generate("volume", 100, tmp_path / "c.ply")
    with pytest.raises(ps.UsageError, match="pipeline"):
        ps.run(tmp_path / "c.ply", None)


def test_reading_files_of_different_systems_takes_ignore_crs(tmp_path):
    pytest.importorskip("pyproj")
    for code in (2154, 25832):
        ps.write(tmp_path / f"{code}.ply", np.zeros((2, 3)), crs=code)
    files = [tmp_path / "2154.ply", tmp_path / "25832.ply"]
    with pytest.raises(ps.Error):
        ps.read(files)
    with pytest.warns(ps.PointsweepWarning, match="ignore_crs"):
        assert len(ps.read(files, ignore_crs=True)["xyz"]) == 4


def test_tiles_and_parts_are_those_of_the_tool(run_tool, tmp_path):
    xyz = np.random.default_rng(3).uniform(-300, 700, (2000, 3))
    ps.write(tmp_path / "a.laz", {"xyz": xyz, "classification": (np.arange(2000) % 3).astype("u1")})
    report = ps.open(tmp_path / "a.laz").run("knn(k=8) | normals", to=tmp_path / "out", tile=500, tile_buffer=20, tile_origin=(100, 0))
    run_tool("normals", tmp_path / "a.laz", tmp_path / "tool/", "-k", "8", "--tile", "500", "--tile-buffer", "20", "--tile-origin", "100,0")
    names = sorted(file.name for file in (tmp_path / "out").iterdir())
    assert names == sorted(file.name for file in (tmp_path / "tool").iterdir()) and "-400_0.laz" in names and len(names) == 9
    assert report.statistics["files_written"] == 9
    for name in names:
        assert (tmp_path / "out" / name).read_bytes() == (tmp_path / "tool" / name).read_bytes()
    assert ps.verify(tmp_path / "out", tmp_path / "a.laz")
    ps.open(tmp_path / "a.laz").write(tmp_path / "classes", split="classification")
    assert sorted(file.name for file in (tmp_path / "classes").iterdir()) == [f"classification_{c}.laz" for c in range(3)]
    assert (ps.read(tmp_path / "classes/classification_1.laz")["classification"] == 1).all()
    ps.run(xyz, "normals", to=tmp_path / "arrays/*.ply", tile=1e6)
    assert len(list((tmp_path / "arrays").iterdir())) == 8 / 2
    for wrong, sentence in (
        ({"tile": 0}, "tile: '0.0' is not above 0"),
        ({"tile": 5, "tile_origin": 3}, "tile_origin: 3 is not two numbers"),
        ({"tile": 5, "split": "part"}, "tile and split each divide the output"),
        ({"split": "intensities"}, "split: the points have no attribute 'intensities'"),
        ({"tile_buffer": 5}, "tile_buffer belong to tile"),
    ):
        with pytest.raises(ps.UsageError, match=sentence):
            ps.run(tmp_path / "a.laz", "normals", to=tmp_path / "x" / "*.laz" if "tile_buffer" not in wrong or "tile" in wrong else tmp_path / "x.laz", **wrong)
    with pytest.raises(ps.UsageError, match="says no format for arrays"):
        ps.run(xyz, "normals", to=tmp_path / "x", tile=5)
    with pytest.raises(ps.UsageError, match="tile: is for outputs in files"):
        ps.run(xyz, "normals", tile=5)


def test_columns_of_a_text_file_are_named(tmp_path):
    file = tmp_path / "a.xyz"
    file.write_text("tree 1 2 3 40\nbush 4 5 6 50\n")
    named = ["-", "x", "y", "z", "intensity"]
    points = ps.open(file, columns=named).read()
    assert points["xyz"].tolist() == [[1, 2, 3], [4, 5, 6]] and points["intensity"].tolist() == [40, 50]
    assert ps.info(file, columns="-,x,y,z,i").points == 2
    ps.open(file, columns=named).write(tmp_path / "a.csv")
    assert ps.verify(tmp_path / "a.csv", file, columns=named)
    with pytest.raises(ps.UsageError, match="columns: 'x,y' does not name z"):
        ps.open(file, columns=["x", "y"])
    with pytest.raises(ps.UsageError, match="leave all but one out"):
        ps.open(file, format="kitti", columns=named)


def test_a_field_called_normal_is_an_attribute_of_its_own(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z,normal\n" + "".join(f"{i},{i % 3},{i % 2},{7 * i}\n" for i in range(20)))
    own = 7 * np.arange(20)
    t = ps.read(tmp_path / "a.csv")
    assert list(t) == ["xyz", "normal"] and np.array_equal(t["normal"], own)
    assert np.array_equal(ps.run(tmp_path / "a.csv", "where(x > 4)", keep=["normal"])["normal"], own[5:])
    assert np.array_equal(ps.run({"xyz": t["xyz"], "normal": own}, "where(x > 4)", keep=["normal"])["normal"], own[5:])
    assert ps.normals(tmp_path / "a.csv", 4).shape == (20, 3)


def test_a_field_called_xyz_is_refused_where_results_have_positions(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z,xyz\n1,2,3,4\n5,6,7,8\n")
    cloud = ps.open(tmp_path / "a.csv")
    for call in (cloud.read, lambda: cloud.chunks(1), lambda: cloud.run("where(x > 0)", keep=["xyz"])):
        with pytest.raises(ps.UsageError, match="the files have an attribute 'xyz', .* rename it first with"):
            call()
    cloud.run("set(w = xyz) | drop(xyz)", to=tmp_path / "b.ply")
    t = ps.read(tmp_path / "b.ply")
    assert np.array_equal(t["xyz"], [[1, 2, 3], [5, 6, 7]]) and np.array_equal(t["w"], [4, 8])


def test_xyz_stands_for_the_positions_in_every_keep(tmp_path):
    xyz = np.random.default_rng(1).random((30, 3))
    points = {"xyz": xyz, "a": np.arange(30), "b": np.arange(30), "color": np.zeros((30, 3), "u1")}
    ps.write(tmp_path / "in.ply", points)
    for cloud in (points, tmp_path / "in.ply"):
        for keep, there in [(["xyz", "a"], ["x", "y", "z", "a"]), ("xyz", ["x", "y", "z"])]:
            ps.write(tmp_path / "out.ply", cloud, keep=keep, overwrite=True)
            assert list(ps.open(tmp_path / "out.ply").attributes) == there
        ps.run(cloud, "knn(k=4) | normals | curvature", to=tmp_path / "out.ply", keep=["xyz", "k1"], overwrite=True)
        assert list(ps.open(tmp_path / "out.ply").attributes) == ["x", "y", "z", "k1"]
        assert "k1" in ps.plan(cloud, "knn(k=4) | normals | curvature", to=tmp_path / "plan.ply", keep=["xyz", "k1"])
    ps.write(tmp_path / "out.ply", points, keep=["color"], overwrite=True)
    assert list(ps.open(tmp_path / "out.ply").attributes) == ["x", "y", "z", "color_0", "color_1", "color_2"]


def test_row_numbers_of_files_are_in_blocks(tmp_path):
    ps.generate("plane", 30, tmp_path / "a.ply")
    with pytest.raises(ps.UsageError, match="keep: 'row' is for points in arrays; chunks gives"):
        ps.run(tmp_path / "a.ply", "where(x > 0)", keep=["row"])


def test_an_attribute_called_x_beside_the_coordinate_is_read(tmp_path):
    (tmp_path / "a.csv").write_text("x,y,z,X,label,Label\n1,2,3,4,5,6\n7,8,9,10,11,12\n")
    assert list(ps.read(tmp_path / "a.csv")) == ["xyz", "X", "label", "Label"]
    assert list(next(ps.chunks(tmp_path / "a.csv", 2))) == ["xyz", "X", "label", "Label", "row"]


def test_names_that_differ_only_in_case_are_two_attributes(tmp_path):
    xyz = np.random.default_rng(1).random((30, 3))
    points = {"xyz": xyz, "Label": np.arange(30), "label": 10 * np.arange(30), "X": np.arange(30) + 0.5}
    ps.write(tmp_path / "a.ply", points)
    for cloud in (points, tmp_path / "a.ply"):
        for t in (
            ps.run(cloud, "where(x >= 0)"),
            ps.run(cloud, "unique", keep=["X", "label", "Label", "xyz"]),
            next(ps.chunks(cloud, 30)),
        ):
            for name, values in points.items():
                assert np.array_equal(t[name], values), name
