# SPDX-License-Identifier: MIT
"""Arrays in and out: layouts, types, selects, movers; normals by NumPy."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import pointsweep as ps


def weighted_normals(xyz: np.ndarray, k: int) -> np.ndarray:
    """Eigenvectors of smallest eigenvalue, unsigned, of the plain covariance of k neighbours and the point."""
    _, rows = cKDTree(xyz).query(xyz, k=k + 1)
    d = xyz[rows] - xyz[rows].mean(1, keepdims=True)
    return np.linalg.eigh(np.einsum("nki,nkj->nij", d, d))[1][:, :, 0]


def test_normals_are_those_of_a_covariance_up_to_weights(surface):
    xyz = surface[300:]  # without duplicates
    n = ps.normals(xyz, k=20)
    assert n.shape == (2700, 3) and n.dtype == np.float32
    np.testing.assert_allclose(np.linalg.norm(n, axis=1), 1, rtol=1e-6)
    cosine = np.abs(np.einsum("ni,ni->n", n, weighted_normals(xyz, 20)))
    assert np.median(cosine) > 0.9995 and np.quantile(cosine, 0.01) > 0.97


def test_orientations(surface):
    assert (ps.normals(surface, orient="up")[:, 2] >= 0).all()
    high = surface.mean(0) + [0, 0, 1000.0]
    n = ps.normals(surface, viewpoint=high)
    assert (np.einsum("ni,ni->n", n, high - surface) >= 0).all()
    down = np.tile(np.float32([0, 0, -1]), (len(surface), 1))
    n = ps.normals({"xyz": surface, "normal": down}, orient="input")
    assert (n[:, 2] <= 0).all()


def test_normals_have_the_bytes_of_the_tool(surface, run_tool, tmp_path):
    np.save(tmp_path / "in.npy", surface)
    run_tool("normals", "in.npy", "out.ply", "-k", 12)
    assert ps.run(tmp_path / "out.ply", "decimate(1)", keep=["normal"])["normal"].tobytes() == ps.normals(surface, 12).tobytes()


def layouts(xyz: np.ndarray, folder):
    """The same points in other layouts."""
    yield "fortran", np.asfortranarray(xyz)
    wide = np.zeros((2 * len(xyz), 7), xyz.dtype)
    wide[::2, 1:6:2] = xyz
    yield "strided", wide[::2, 1:6:2]
    yield "reversed", np.ascontiguousarray(xyz[::-1, ::-1])[::-1, ::-1]
    packed = np.zeros(len(xyz), [("i", "u1"), ("x", xyz.dtype), ("y", xyz.dtype), ("z", xyz.dtype)])
    packed["x"], packed["y"], packed["z"] = xyz.T
    yield "packed records", packed[["x", "y", "z"]]
    np.save(folder / "xyz.npy", xyz)
    yield "memory-mapped", np.load(folder / "xyz.npy", mmap_mode="r")
    yield "other byte order", xyz.astype(xyz.dtype.newbyteorder())
    yield "columns", {"x": xyz[:, 0], "y": xyz[:, 1], "z": xyz[:, 2]}
    fixed = xyz.copy()
    fixed.flags.writeable = False
    yield "read-only", fixed
    yield "nested lists", xyz.tolist() if xyz.dtype == np.float64 else fixed


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_the_layout_of_an_array_changes_no_byte(surface, dtype, tmp_path):
    xyz = (surface - surface.min(0)).astype(dtype)
    expected = ps.run(xyz, "knn(k=9) | normals | features")
    for name, points in layouts(xyz, tmp_path):
        got = ps.run(points, "knn(k=9) | normals | features")
        assert got.keys() == expected.keys(), name
        for key in expected:
            assert got[key].tobytes() == expected[key].tobytes(), (name, key)


def test_integers_are_coordinates_too():
    xyz = np.random.default_rng(1).integers(-1000, 1000, (500, 3))
    for dtype in (np.int32, np.int16, np.int64):
        got = ps.neighbors(xyz.astype(dtype), k=5)
        assert np.array_equal(got.indices, ps.neighbors(xyz.astype(float), k=5).indices), dtype


def test_results_hold_what_is_made(surface):
    arrays = ps.run(surface, "knn(k=16) | normals | sor")
    assert list(arrays) == ["normal", "mean_distance", "outlier"]
    assert arrays["normal"].shape == (3000, 3) and arrays["outlier"].shape == (3000,)
    assert arrays.report.points == 3000
    assert "normal" in repr(arrays) and "3,000 points" in repr(arrays)
    arrays["outlier"][:] = 1  # writable


def test_keep_names_what_is_returned_in_its_order(surface):
    arrays = ps.run(surface, "knn(k=16) | normals | sor", keep=["outlier", "nx", "xyz", "row", "normal"])
    assert list(arrays) == ["outlier", "nx", "xyz", "row", "normal"]
    assert np.array_equal(arrays["nx"], arrays["normal"][:, 0])
    assert np.array_equal(arrays["xyz"], surface) and np.array_equal(arrays["row"], np.arange(3000))


def test_selects_return_the_rows_kept(surface):
    intensity = np.arange(3000, dtype=np.uint16)
    text = "knn(k=8) | where(intensity < 1000) | normals"
    arrays = ps.run(surface, text, attributes={"intensity": intensity})
    assert np.array_equal(arrays["row"], np.arange(1000))
    assert np.array_equal(arrays["xyz"], surface[:1000])
    assert arrays["intensity"].dtype == np.uint16 and np.array_equal(arrays["intensity"], intensity[:1000])
    assert arrays["normal"].tobytes() == ps.normals(surface[:1000], 8).tobytes()
    thin = ps.run(surface, "voxel(1)")
    cells = np.floor(surface[thin["row"]])
    assert len(np.unique(cells, axis=0)) == len(cells) == len(np.unique(np.floor(surface), axis=0))


def test_the_order_of_the_sweep_says_which_rows(surface):
    arrays = ps.run(surface, "knn(k=8) | normals", order="sweep", axis="x")
    assert np.array_equal(arrays["xyz"], surface[arrays["row"]])
    assert (np.diff(arrays["xyz"][:, 0]) >= 0).all()
    assert arrays["normal"].tobytes() == ps.normals(surface, 8)[arrays["row"]].tobytes()


def test_movers_return_positions(surface):
    arrays = ps.run(surface, "knn(k=12) | normals | splats | fair(f=0.1, g=0.1)")
    assert arrays["xyz"].shape == (3000, 3) and arrays["xyz"].dtype == np.float64
    assert 0 < np.abs(arrays["xyz"] - surface).max() < 1
    assert "normal" in arrays


def test_attributes_pass_through_and_lists_stay_together(surface):
    color = np.random.default_rng(2).integers(0, 256, (3000, 3)).astype(np.uint8)
    flag = np.arange(3000) % 3 == 0
    arrays = ps.run({"xyz": surface, "color": color, "flag": flag}, "where(flag == 1)")
    assert np.array_equal(arrays["color"], color[flag]) and arrays["color"].dtype == np.uint8
    records = np.zeros(3000, [("x", "f8"), ("y", "f8"), ("z", "f8"), ("t", "i8"), ("c", "u2", 2)])
    records["x"], records["y"], records["z"] = surface.T
    records["t"] = np.arange(3000) + 2**60
    arrays = ps.run(records, "where(t < 1152921504606847986)")
    assert np.array_equal(arrays["t"], records["t"][:1010]) and arrays["c"].shape == (1010, 2)
    arrays = ps.run(records, ps.where("t in (1152921504606846977, 1152921504606846979) or x between 0.5 and 0.6"))
    kept = np.isin(records["t"] - 2**60, (1, 3)) | (records["x"] >= 0.5) & (records["x"] <= 0.6)
    assert np.array_equal(arrays["t"], records["t"][kept])


@pytest.mark.filterwarnings("ignore:k = 16 is more")
def test_one_point_has_no_normal_and_no_points_are_an_error():
    assert ps.normals(np.zeros((1, 3))).tolist() == [[0, 0, 0]]
    arrays = ps.run(np.zeros((1, 3), np.float32), "voxel(1)")
    assert arrays["xyz"].shape == (1, 3) and arrays["row"].tolist() == [0]
    with pytest.raises(ps.Error, match="no points"):
        ps.normals(np.zeros((0, 3)))


def test_all_rows_may_be_left_out(surface):
    with pytest.warns(ps.PointsweepWarning, match="no point passed"):
        arrays = ps.run(surface, "where(z < 0)")
    assert arrays["xyz"].shape == (0, 3) and arrays["row"].shape == (0,)


def test_rows_that_are_not_finite_stay_without_results(surface):
    xyz = surface.copy()
    xyz[10] = np.nan
    n = ps.normals(xyz, 8)
    assert (n[10] == 0).all() and (np.delete(n, 10, 0) == ps.normals(np.delete(xyz, 10, 0), 8)).all()
    with pytest.warns(ps.PointsweepWarning, match="Dropped 1 point"):
        dropped = ps.run(xyz, "knn(k=8) | normals", nonfinite="drop")
    assert 10 not in dropped["row"] and len(dropped["row"]) == 2999


def test_a_small_budget_spills_and_changes_no_byte():
    xyz = ps.generate("terrain", 500_000)["xyz"]
    text = "knn(k=8) | normals"
    expected = ps.run(xyz, text, threads=2)
    small = ps.run(xyz, text, threads=1, memory="40M")
    assert small.report.statistics["bytes"]["spilled"] > 0 == expected.report.statistics["bytes"]["spilled"]
    for key in expected:
        assert small[key].tobytes() == expected[key].tobytes()


def test_arrays_go_to_files(surface, tmp_path):
    report = ps.run(surface, "knn(k=8) | normals", to=tmp_path / "out.ply")
    assert report.points_written == 3000 and "out.ply" in repr(report)
    back = ps.run(tmp_path / "out.ply", "decimate(1)")
    assert np.array_equal(back["xyz"], surface) and back["normal"].tobytes() == ps.normals(surface, 8).tobytes()


def test_results_are_written_to_arrays_that_are_there(surface, tmp_path):
    expected = ps.normals(surface, 8)
    mapped = np.lib.format.open_memmap(tmp_path / "normals.npy", "w+", np.float32, (3000, 3))
    k1 = np.empty(3000, np.float32)
    t = ps.run(surface, "knn(k=8) | normals | curvature", out={"normal": mapped, "k1": k1})
    assert t["normal"] is mapped and t["k1"] is k1 and set(t) == {"normal", "k1"}
    assert mapped.tobytes() == expected.tobytes() and k1.max() > 0
    assert list(t.columns()) == ["nx", "ny", "nz", "k1"]
    mapped.flush()
    assert np.load(tmp_path / "normals.npy").tobytes() == expected.tobytes()
    into = np.empty((3000, 3), np.float32)
    assert ps.normals(surface, 8, out=into) is into and into.tobytes() == expected.tobytes()
    both = ps.run(surface, "knn(k=8) | normals", keep=["xyz", "normal"], out={"normal": into})
    assert both["normal"] is into and both["xyz"].tobytes() == surface.tobytes()


@pytest.mark.parametrize(
    ("array", "sentence"),
    [
        (np.empty((3000, 3)), "3000 rows of 3 float64, but the result has 3000 rows of 3 float32"),
        (np.empty((2999, 3), "f4"), "2999 rows"),
        (np.empty(9000, "f4"), "9000 rows"),
        (np.empty((3000, 4), "f4")[:, :3], "not contiguous"),
        (np.broadcast_to(np.float32(0), (3000, 3)), "read-only"),
        (np.empty((3000, 3), ">f4"), "which no result is"),
        (np.empty((3000, 3), object), "which no result is"),
        ([[0.0, 0.0, 0.0]] * 3000, "give an array of NumPy"),
    ],
)
def test_arrays_that_results_do_not_fit_are_refused(surface, array, sentence):
    with pytest.raises(ps.UsageError, match=sentence):
        ps.run(surface, "knn(k=8) | normals", out={"normal": array})


def test_out_gives_the_first_rows_where_rows_are_left_out():
    line = np.c_[np.arange(6.0), np.zeros((6, 2))]
    into = np.full((6, 3), -9, "f4")
    kept = ps.run(line, "knn(k=1) | normals | where(x < 2)", keep=["xyz", "normal"], out={"normal": into})
    assert kept["normal"].shape == kept["xyz"].shape == (2, 3)
    assert np.shares_memory(kept["normal"], into) and (into[2:] == -9).all()


def test_out_is_for_arrays_of_the_result(surface, tmp_path):
    normal = np.empty((3000, 3), np.float32)
    with pytest.raises(ps.UsageError, match="leave it out"):
        ps.run(surface, "knn(k=8) | normals", to=tmp_path / "a.ply", out={"normal": normal})
    with pytest.raises(ps.UsageError, match="among what keep names"):
        ps.run(surface, "knn(k=8) | normals", keep="xyz", out={"normal": normal})
    with pytest.raises(ps.UsageError, match="is no dict"):
        ps.run(surface, "knn(k=8) | normals", out=normal)


def test_neighbours_that_nobody_names_are_as_many_as_the_operators_want(surface):
    assert ps.normals(surface).tobytes() == ps.normals(surface, 16).tobytes()
    text = "normals | curvature"
    for pipeline in (text, ["normals", "curvature"], ps.normals() | ps.curvature(), f"knn | {text}"):
        made = ps.run(surface, pipeline, keep=["k1"])["k1"]
        assert made.tobytes() == ps.run(surface, f"knn(k=32) | {text}", keep=["k1"])["k1"].tobytes()
    assert ps.neighbors(surface).indices.shape == (len(surface), 16)


def test_degrees_have_no_distances_and_feet_convert_what_is_in_metres(surface):
    degrees = 'GEOGCS["WGS 84",DATUM["d",SPHEROID["s",6378137,298.25]],UNIT["degree",0.0174532925199433]]'
    with pytest.raises(ps.UsageError, match="degrees of 'WGS 84', between which 'normals'"):
        ps.run(surface, "normals", crs=degrees)
    assert len(ps.run(surface, "where(z > -9)", crs=degrees)["row"]) > 0
    feet = f'PROJCS["ft",{degrees},UNIT["foot",0.3048]]'
    with pytest.warns(ps.PointsweepWarning, match=r"ground: the unit of the cloud is ft.*cell=3.281 \(1 m\)"):
        made = ps.run(surface / 0.3048, "ground", crs=feet)["classification"]
    assert made.tobytes() == ps.run(surface, "ground")["classification"].tobytes()


def test_copies_and_unions_of_results_are_results(surface):
    t = ps.run(surface, "knn(k=8) | normals | curvature", keep=["xyz", "k1_direction"], crs=25832)
    other = ps.run(surface, "color(z)", keep=["color"])
    label = np.arange(3000)
    for made, names in [
        (t.copy(), ["x", "y", "z", "k1_x", "k1_y", "k1_z"]),
        (t | {"label": label}, ["x", "y", "z", "k1_x", "k1_y", "k1_z", "label"]),
        ({"label": label} | t, ["label", "x", "y", "z", "k1_x", "k1_y", "k1_z"]),
        (t | other, ["x", "y", "z", "k1_x", "k1_y", "k1_z", "red", "green", "blue"]),
        (other | t, ["red", "green", "blue", "x", "y", "z", "k1_x", "k1_y", "k1_z"]),
    ]:
        assert isinstance(made, ps.Arrays) and list(made.columns()) == names
        assert made.crs == t.crs and made.crs.epsg == 25832 and made.report is not None
        assert made["xyz"] is t["xyz"]
    grown = t.copy()
    grown |= other
    paired = grown.copy()
    paired |= [("again", grown["xyz"][:, 0])]
    assert type(paired) is type(grown) and paired.crs == grown.crs and paired["again"] is not None and "again" not in grown
    assert isinstance(grown, ps.Arrays) and list(grown.columns())[-3:] == ["red", "green", "blue"] and "color" not in t
    with pytest.raises(TypeError):
        t | 3


def test_results_given_back_keep_the_names_of_components(surface, tmp_path):
    curved = "knn(k=8) | normals | curvature | splats"
    keep = ["xyz", "k1_direction", "normal_eigenvalues"]
    t = ps.run(surface, curved, keep=keep) | ps.run(surface, "color(z)", keep=["color"])
    names = list(t.columns())
    ps.write(tmp_path / "a.ply", t)
    ps.write(tmp_path / "b.ply", iter([t, t]))
    ps.write(tmp_path / "c.ply", ps.chunks(t, 1000))
    for name in "abc":
        there = list(ps.open(tmp_path / f"{name}.ply").attributes)
        assert [field for field in there if field != "row"] == names, name
    assert {"k1_x", "red", "normal_eigenvalue_0"} <= set(names)
    again = ps.run(t, "where(red >= 0)")
    assert list(again) == [*t, "row"] and again["color"].tobytes() == t["color"].tobytes()
    turned = ps.run(t, "transform([0,-1,0,0, 1,0,0,0, 0,0,1,0, 0,0,0,1])", keep=["k1_direction"])["k1_direction"]
    np.testing.assert_allclose(turned, t["k1_direction"][:, [1, 0, 2]] * [-1, 1, 1], atol=1e-6)

    @ps.operator(reads=["k1_direction"], makes={"copied": ("f8", 3)}, neighbors=False)
    def copied(p):
        return p.k1_direction

    assert np.array_equal(ps.run(t, copied)["copied"], t["k1_direction"])
    t["color"] = t["color"][:, :2]  # no longer what the run made
    assert ps.run(t, "where(color_0 >= 0)")["color"].shape == (3000, 2)


def test_out_may_be_the_input_itself_but_no_other_part_of_its_memory():
    big = np.random.default_rng(3).random((60, 3))
    xyz, turn = big[:50], "transform([0,-1,0,5, 1,0,0,6, 0,0,1,7, 0,0,0,1])"
    expected = ps.run(xyz, turn)["xyz"]
    with pytest.raises(ps.UsageError, match="out: 'xyz' shares memory with 'xyz' of the input; give a copy"):
        ps.run(xyz, turn, out={"xyz": big[10:]})
    weights = np.arange(120.0)
    with pytest.raises(ps.UsageError, match="out: 'b' shares memory with 'a' of the input"):
        ps.run({"xyz": xyz, "a": weights[::2][:50]}, "set(b = a + 1)", out={"b": weights[40:90]})
    with pytest.raises(ps.UsageError, match="out: 'c' and 'b' share memory"):
        ps.run({"xyz": xyz, "a": weights[:50]}, "set(b = a) | set(c = a)", out={"b": weights[60:110], "c": weights[61:111]})
    counts = np.arange(50.0)
    assert ps.run({"xyz": xyz, "a": counts}, "set(a = a + 1)", out={"a": counts})["a"] is counts
    assert np.array_equal(counts, np.arange(50.0) + 1)
    beside = np.empty((50, 2, 3))
    beside[:, 0] = xyz
    ps.run(beside[:, 0], turn, out={"xyz": big[:50]})
    assert np.array_equal(big[:50], expected)
    again = ps.run(beside[:, 0], turn)["xyz"]
    own = np.ascontiguousarray(beside[:, 0])
    assert ps.run(own, turn, out={"xyz": own})["xyz"] is own and np.array_equal(own, again)
