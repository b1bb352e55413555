# SPDX-License-Identifier: MIT
"""Arrays beside files, and polygons and tables of geopandas."""

import numpy as np
import pytest

import pointsweep as ps


@pytest.fixture
def tiles(tmp_path):
    """Two LAZ files with a class, an extra attribute and a coordinate system."""
    random = np.random.default_rng(8)
    for i in range(2):
        xyz = np.round(random.random((1500, 3)) * 100, 2) + [500000 + 100 * i, 5400000, 0]
        points = {"xyz": xyz, "classification": random.integers(0, 9, 1500).astype("u1"), "gain": random.random(1500)}
        ps.write(tmp_path / f"tile_{i}.laz", points, crs=25832, scale=0.01)
    return tmp_path / "*.laz"


def test_columns_are_added_and_nothing_else_changes(tiles, tmp_path):
    cloud = ps.open(tiles)
    label = np.arange(3000, dtype=np.int32)[::-1]
    axis = np.random.default_rng(3).random((3000, 3)).astype(np.float32)
    labelled = cloud.with_columns(label=label).with_columns(axis=axis)
    assert labelled.attributes["label"] == np.int32 and len(labelled) == 3000
    labelled.write(tmp_path / "out.laz")
    before, after = cloud.read(), ps.read(tmp_path / "out.laz")
    for name, values in before.items():
        np.testing.assert_array_equal(after[name], values, err_msg=name)
    np.testing.assert_array_equal(after["label"], label)
    np.testing.assert_array_equal(np.column_stack([after[f"axis_{i}"] for i in range(3)]), axis)
    assert ps.open(tmp_path / "out.laz").crs.epsg == 25832
    read = labelled.read()
    np.testing.assert_array_equal(read["label"], label)
    np.testing.assert_array_equal(read["xyz"], before["xyz"])


def test_columns_take_the_place_of_attributes_and_stages_read_them(tiles, tmp_path):
    cloud = ps.open(tiles)
    classes = np.memmap(tmp_path / "classes", np.uint8, "w+", shape=3000)
    classes[:] = np.arange(3000) % 7
    changed = cloud.with_columns(classification=classes)
    changed.write(f"{tmp_path}/all/")
    folder = ps.read(sorted((tmp_path / "all").glob("*.laz")))
    np.testing.assert_array_equal(folder["classification"], classes)
    some = changed.run("where(classification == 2)", keep=["xyz", "classification"])
    np.testing.assert_array_equal(some["xyz"], cloud.read()["xyz"][classes == 2])
    assert set(some["classification"]) == {2}
    again = changed.run("knn(k=4) | normals", keep=["normal", "classification"], memory="64M", threads=2)
    np.testing.assert_array_equal(again["classification"], classes)
    np.testing.assert_array_equal(again["normal"], cloud.run("knn(k=4) | normals")["normal"])


def test_columns_that_do_not_fit_are_refused(tiles, tmp_path):
    cloud = ps.open(tiles)
    with pytest.raises(ps.UsageError, match=r"label: has the shape \(2999,\), but the files have 3000 points"):
        cloud.with_columns(label=np.zeros(2999))
    with pytest.raises(ps.UsageError, match="name at least one array"):
        cloud.with_columns()
    with pytest.raises(ps.UsageError, match="label: is an array of objects"):
        cloud.with_columns(label=np.array([None] * 3000))
    with pytest.raises(ps.UsageError, match=r"add arrays to files with open\(files\).with_columns"):
        ps.run(cloud, "normals", attributes={"label": np.zeros(3000)})


def test_checkpoints_of_other_columns_are_not_resumed(tiles, tmp_path):
    cloud, kept = ps.open(tiles), tmp_path / "kept"
    label = np.arange(3000, dtype=np.uint16)
    cloud.with_columns(label=label).run("knn(k=4) | normals", to=tmp_path / "a.laz", resume=kept)
    cloud.with_columns(label=label + 1).run("knn(k=4) | normals", to=tmp_path / "b.laz", resume=kept)
    np.testing.assert_array_equal(ps.read(tmp_path / "b.laz")["label"], label + 1)


def test_points_without_a_place_keep_their_rows_of_columns(tmp_path):
    xyz, ident = np.random.default_rng(4).random((1000, 3)), np.arange(1000.0)
    xyz[::7, 1] = np.nan
    ps.write(tmp_path / "a.ply", {"xyz": xyz, "ident": ident})
    labelled = ps.open(tmp_path / "a.ply").with_columns(label=np.arange(1000))
    finite = "knn(k=4) | where(x - x == 0 and y - y == 0 and z - z == 0) | normals"
    for pipeline, n in [("knn(k=4) | normals", 1000), (finite, 857)]:
        for result in [
            labelled.run(pipeline, keep=["ident", "label"]),
            labelled.run(pipeline, to=tmp_path / "b.ply", overwrite=True) and ps.read(tmp_path / "b.ply"),
        ]:
            assert len(result["label"]) == n
            np.testing.assert_array_equal(result["label"], result["ident"])
    for act in (lambda: labelled.read(nonfinite="drop"), lambda: labelled.run("decimate(1)", nonfinite="drop")):
        with pytest.raises(ps.UsageError, match="would give their rows of the columns to others"):
            act()


def test_points_come_as_a_table_of_geopandas_and_back(tiles):
    geopandas = pytest.importorskip("geopandas")
    cloud = ps.open(tiles)
    frame = cloud.run("knn(k=4) | normals", keep=["xyz", "normal", "classification"]).to_geopandas()
    assert isinstance(frame, geopandas.GeoDataFrame) and frame.crs.to_epsg() == 25832
    assert list(frame.columns) == ["nx", "ny", "nz", "classification", "geometry"]
    back = ps.run(frame, "decimate(1)", keep=["xyz", "classification"])
    np.testing.assert_array_equal(back["xyz"], cloud.read()["xyz"])
    with pytest.raises(ps.UsageError, match="there is no 'xyz'"):
        cloud.run("knn(k=4) | normals").to_geopandas()


def test_polygons_of_shapely_and_geopandas_crop(tiles):
    shapely = pytest.importorskip("shapely")
    geopandas = pytest.importorskip("geopandas")
    cloud = ps.open(tiles)
    xyz = cloud.read()["xyz"]
    ring = shapely.box(500020, 5400020, 500080, 5400080) - shapely.box(500040, 5400040, 500060, 5400060)
    disc = shapely.Point(500100.123456789, 5400050).buffer(30)  # lies over the edge of ring and both tiles
    points = shapely.points(xyz[:, :2])
    in_ring, in_disc = shapely.covers(ring, points), shapely.covers(disc, points)
    for shape, inside in [
        (ring, in_ring),
        (disc, in_disc),
        (shapely.MultiPolygon([ring, shapely.box(500150, 5400000, 500160, 5400010)]), None),
        (shapely.GeometryCollection([ring, disc]), in_ring | in_disc),
        (geopandas.GeoSeries([ring, disc], crs=25832), in_ring | in_disc),
        (geopandas.GeoDataFrame({"name": ["a", "b"]}, geometry=[ring, disc], crs=25832), in_ring | in_disc),
    ]:
        kept = cloud.run(ps.crop(polygon=shape), keep=["xyz"])["xyz"]
        expected = xyz[shapely.covers(shape, points) if inside is None else inside]
        np.testing.assert_array_equal(kept, expected, err_msg=type(shape).__name__)
    assert len(in_ring.nonzero()[0]) > 100
    for shape, words in [(shapely.Point(1, 2), "a Point has no inside"), (shapely.Polygon(), "there are no polygons")]:
        with pytest.raises(ps.UsageError, match=words):
            ps.crop(polygon=shape)
    with pytest.raises(ps.UsageError, match="is not a path"):
        ps.distance_to(geopandas.GeoSeries([shapely.Point(1, 2, 3)]))


def test_xyz_is_not_the_name_of_a_column(tiles):
    with pytest.raises(ps.UsageError, match="replace them with x=, y= and z="):
        ps.open(tiles).with_columns(xyz=np.zeros((3000, 3)))
