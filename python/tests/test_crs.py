# SPDX-License-Identifier: MIT
"""Coordinate reference systems of points in arrays, and of objects of other libraries."""

import numpy as np
import pytest

import pointsweep as ps

XYZ = np.random.default_rng(4).random((200, 3)) * 100 + [500000, 5400000, 100]
ALL = "decimate(1)"


def written(points, folder, **options):
    """Writes `points`, or the points that they return if they are a function, as LAS and PLY. Returns the system of the files."""
    found = []
    for extension in ("las", "ply"):
        path = folder / f"out.{extension}"
        ps.run(points() if callable(points) else points, ALL, to=path, overwrite=True, **options)
        found.append(ps.open(path).crs)
    assert found[0] is not None and str(found[0]) == str(found[1])
    return found[0]


@pytest.fixture(scope="module")
def pyproj():
    return pytest.importorskip("pyproj")


@pytest.mark.parametrize("code", [25832, 2154, 2263, 4978])
def test_a_system_is_given_in_any_form_and_written(pyproj, tmp_path, code):
    system = pyproj.CRS(code)
    for form in (code, f"EPSG:{code}", system, system.to_wkt(), system.to_wkt("WKT1_GDAL")):
        crs = written(XYZ, tmp_path, crs=form)
        assert crs.epsg == code and pyproj.CRS(crs).equals(system, ignore_axis_order=True)
    assert written({"x": XYZ[:, 0], "y": XYZ[:, 1], "z": XYZ[:, 2]}, tmp_path, crs=crs) == crs
    assert written(lambda: iter([XYZ[:50], XYZ[50:]]), tmp_path, crs=crs) == crs


def test_heights_have_a_system_too(pyproj, tmp_path):
    crs = written(XYZ, tmp_path, crs="EPSG:25832+7837")
    assert (crs.epsg, crs.vertical_epsg) == (25832, 7837) and pyproj.CRS(crs) == pyproj.CRS("EPSG:25832+7837")


def test_well_known_text_needs_no_other_package(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pyproj", None)
    wkt = 'PROJCS["mine",GEOGCS["g",DATUM["d",SPHEROID["s",6378137,298.25]],PRIMEM["Greenwich",0],UNIT["degree",0.0174]],UNIT["metre",1]]'
    crs = written(XYZ, tmp_path, crs=wkt)
    assert crs.name == "mine" and crs.wkt == wkt == crs.to_wkt()
    with pytest.raises(ps.UsageError, match="pyproj, which looks up 'EPSG:25832', is not installed"):
        ps.run(XYZ, ALL, crs=25832)


@pytest.fixture(scope="module")
def laspy():
    return pytest.importorskip("laspy")


@pytest.mark.parametrize("point_format", [3, 7])
def test_points_of_laspy_keep_their_system(pyproj, laspy, tmp_path, point_format):
    las = laspy.create(point_format=point_format, file_version="1.4")
    las.header.offsets, las.header.scales = [500000, 5400000, 0], [0.001] * 3
    las.x, las.y, las.z = XYZ.T
    las.header.add_crs(pyproj.CRS(25832))
    path = tmp_path / "in.las"
    las.write(path)
    stated = ps.open(path).crs
    assert stated.epsg == 25832 and pyproj.CRS(stated) == pyproj.CRS(25832)
    assert ps.run(las, ALL).crs == stated == ps.run(laspy.read(path), ALL).crs
    with laspy.open(path) as reader:
        t = ps.run(reader, ALL)
    with laspy.open(path) as reader:
        blocks = ps.run(reader.chunk_iterator(70), ALL)
    assert t.crs == blocks.crs == stated and t["xyz"].tobytes() == blocks["xyz"].tobytes() == ps.run(path, ALL)["xyz"].tobytes()
    if point_format == 7:  # the WKT that format 6 and later ask for
        assert written(las, tmp_path) == stated
    with pytest.raises(ps.UsageError, match="25833.* is given, but the points state EPSG:25832"):
        ps.run(las, ALL, crs=25833)
    assert ps.run(las, ALL, crs=25832).crs.epsg == 25832


def test_tables_of_geopandas_keep_their_system(pyproj, tmp_path):
    geopandas = pytest.importorskip("geopandas")
    points = geopandas.points_from_xy(*XYZ.T)
    frame = geopandas.GeoDataFrame({"intensity": np.arange(200)}, geometry=points, crs=25832)
    t = ps.run(frame, "where(intensity < 10)")
    assert t["xyz"].tobytes() == XYZ[:10].tobytes() and t.crs.epsg == 25832
    assert written(frame, tmp_path).epsg == 25832 and written(frame.geometry, tmp_path).epsg == 25832
    flat = geopandas.GeoDataFrame({"x": XYZ[:, 0], "y": XYZ[:, 1], "z": XYZ[:, 2]}, geometry=geopandas.points_from_xy(*XYZ.T[:2]), crs=25832)
    assert ps.run(flat, ALL)["xyz"].tobytes() == XYZ.tobytes() and ps.run(flat, ALL).crs.epsg == 25832
    with pytest.raises(ps.UsageError, match="points with a height"):
        ps.run(flat.geometry, ALL)


@ps.operator(makes={"roughness": "f8"})
def roughness(p):
    return p.xyz[:, 0] - p.neighbors_xyz[:, 0, 0]


class Table:
    """As a GeoDataFrame, for where geopandas is not installed."""

    class Geometry:
        name = "geometry"
        x, y, z = XYZ.T
        geom_type, has_z = np.full(200, "Point"), np.full(200, True)

    geometry, has_z, columns = Geometry(), Geometry.has_z, ("geometry",)

    def __init__(self, crs):
        self.crs = crs


def test_a_table_is_known_by_what_it_has(pyproj):
    t = ps.run(Table(pyproj.CRS(2154)), ALL)
    assert t["xyz"].tobytes() == XYZ.tobytes() and t.crs.epsg == 2154


def test_results_and_blocks_of_files_know_the_system_of_the_files(pyproj, tmp_path):
    ps.run(XYZ, ALL, to=tmp_path / "in.las", crs=25832)
    cloud = ps.open(tmp_path / "in.las")
    t = cloud.run(ALL)
    assert t.crs == cloud.crs == written(t, tmp_path)
    assert written(lambda: cloud.chunks(60), tmp_path) == cloud.crs
    other = ps.run(XYZ, ALL, crs=25833)
    with pytest.raises(ps.UsageError, match="block 1 is in EPSG:25833.*first one is in EPSG:25832"):
        ps.run(iter([t, other]), ALL)


@pytest.mark.parametrize(
    ("crs", "sentence"),
    [
        (3.5, "give an EPSG code, WKT or a pyproj.CRS"),
        (True, "give an EPSG code"),
        ('PROJCS["cut off"', "is not well-known text"),
        ("no such system", "is not a coordinate system"),
        (999999, "is not a coordinate system"),
    ],
)
def test_what_is_no_system_is_refused(pyproj, crs, sentence):
    with pytest.raises(ps.UsageError, match=sentence):
        ps.run(XYZ, ALL, crs=crs)


@ps.reduce(start=0)
def count(n, block):
    return n + len(block["xyz"])


@pytest.mark.parametrize(
    "call",
    [
        lambda crs: ps.plan(XYZ, ALL, crs=crs),
        lambda crs: ps.chunks(XYZ, 10, ALL, crs=crs),
        lambda crs: ps.normals(XYZ, 3, crs=crs),
        lambda crs: ps.neighbors(XYZ, 3, crs=crs),
        lambda crs: ps.neighbors(XYZ, radius=1, crs=crs),
        lambda crs: ps.check(roughness, XYZ, crs=crs),
        lambda crs: count(XYZ, ALL, crs=crs),
    ],
)
def test_whatever_takes_arrays_takes_a_system(pyproj, call):
    call(25832)
    with pytest.raises(ps.UsageError, match="give an EPSG code"):
        call(3.5)


def test_points_are_compared_with_other_systems_only_if_asked(pyproj, tmp_path):
    ps.run(XYZ, ALL, to=tmp_path / "other.las", crs=25833)
    stage = ps.distance_to(tmp_path / "other.las")
    assert ps.run(XYZ, stage)["cloud_distance"].max() < 0.01
    with pytest.raises(ps.UsageError, match="25833.*25832.* ignore_crs=True"):
        ps.run(XYZ, stage, crs=25832)
    assert ps.run(XYZ, stage, crs=25832, ignore_crs=True)["cloud_distance"].max() < 0.01
    ps.run(XYZ, ALL, to=tmp_path / "mine.las", crs=25832)
    files = [tmp_path / "mine.las", tmp_path / "other.las"]
    with pytest.raises(ps.UsageError, match="ignore_crs"):
        ps.run(files, ALL)
    with pytest.warns(ps.PointsweepWarning, match="without a transformation"):
        assert len(ps.run(files, ALL, ignore_crs=True)["xyz"]) == 400


def test_the_system_of_files_is_stated_or_replaced(pyproj, tmp_path):
    path, prj = tmp_path / "a.las", tmp_path / "l93.prj"
    ps.run(XYZ, ALL, to=path)
    prj.write_text(pyproj.CRS(2154).to_wkt("WKT1_GDAL"))
    for crs in (2154, "EPSG:2154", prj, str(prj)):
        assert ps.open(path, crs=crs).crs.epsg == 2154
        ps.run(path, ALL, to=tmp_path / "b.las", crs=crs, overwrite=True)
        assert ps.open(tmp_path / "b.las").crs.epsg == 2154
    with pytest.raises(ps.UsageError, match="states EPSG:2154"):
        ps.open(tmp_path / "b.las", crs=25832)
    other = ps.open(tmp_path / "b.las", crs=25832, replace_crs=True)
    other.run(ALL, to=tmp_path / "c.las")
    assert other.crs.epsg == ps.open(tmp_path / "c.las").crs.epsg == 25832
    assert other.run(ALL)["xyz"].tobytes() == ps.run(path, ALL)["xyz"].tobytes()
    ps.open(tmp_path / "b.las", crs="none").run(ALL, to=tmp_path / "d.las")
    assert ps.open(tmp_path / "d.las").crs is None
    with pytest.raises(ps.UsageError, match="replace_crs: belongs to crs"):
        ps.open(path, replace_crs=True)
    with pytest.raises(ps.UsageError, match="open\\(files, crs"):
        ps.run(other, ALL, crs=2154)
