# SPDX-License-Identifier: MIT
"""Neighbours against SciPy, and against a sort by the documented order."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import pointsweep as ps


def by_sorting(xyz: np.ndarray, k: int) -> np.ndarray:
    """Rows of the k nearest by distance, then x, y, z, then row."""
    rows = []
    for i, p in enumerate(xyz):
        d = xyz - p
        d2 = (d[:, 0] * d[:, 0] + d[:, 1] * d[:, 1]) + d[:, 2] * d[:, 2]
        order = np.lexsort((np.arange(len(xyz)), xyz[:, 2], xyz[:, 1], xyz[:, 0], d2))
        rows.append(order[order != i][:k])
    return np.array(rows)


def test_rows_are_those_of_a_sort_by_distance_and_ties(surface):
    xyz = surface[:400].copy()
    xyz[300:] = np.round(xyz[300:])  # many equal distances
    assert np.array_equal(ps.neighbors(xyz, k=9).indices, by_sorting(xyz, 9))


def test_distances_are_those_of_scipy(surface):
    expected, _ = cKDTree(surface).query(surface, k=17)
    indices, distances = ps.neighbors(surface)  # 16 by default
    assert indices.shape == distances.shape == (3000, 16)
    assert indices.dtype == np.uint32 and distances.dtype == np.float64
    np.testing.assert_allclose(distances, expected[:, 1:], rtol=1e-12, atol=0)


def test_lists_within_a_radius_are_those_of_scipy(surface):
    offsets, indices, distances = ps.neighbors(surface, radius=0.4)
    expected = cKDTree(surface).query_ball_point(surface, 0.4)
    assert offsets.dtype == np.int64 and offsets[0] == 0 and len(offsets) == len(surface) + 1
    for i, rows in enumerate(expected):
        mine = indices[offsets[i] : offsets[i + 1]]
        assert sorted(mine) == sorted(set(rows) - {i})
        d = distances[offsets[i] : offsets[i + 1]]
        assert np.all(np.diff(d) >= 0)
        np.testing.assert_allclose(d, np.linalg.norm(surface[mine] - surface[i], axis=1), rtol=1e-12)


def test_k_and_radius_together_pad_what_is_missing(surface):
    indices, distances = ps.neighbors(surface, k=12, radius=0.3)
    expected, rows = cKDTree(surface).query(surface, k=13, distance_upper_bound=0.3)
    missing = np.isinf(expected[:, 1:])
    assert missing.any() and not missing.all()
    assert np.array_equal(np.isnan(distances), missing)
    assert np.array_equal(indices == np.iinfo(np.uint32).max, missing)


@pytest.mark.parametrize("points", [3000, 5])
def test_places_without_a_neighbour_never_stand_for_a_point(surface, points):
    xyz = surface[:points].copy()
    xyz[3] = np.nan
    near = ps.neighbors(xyz, k=3, radius=0.2)
    assert not near.mask.all() and near.mask.any() == (points == 3000)
    with pytest.raises(IndexError):
        xyz[near.indices]
    found, rows = near.of(xyz), near.of(np.arange(points))
    assert found.shape == (points, 3, 3) and np.array_equal(np.isnan(found).any(2), ~near.mask)
    assert np.array_equal(found[near.mask], xyz[near.indices[near.mask]])
    assert np.array_equal(rows, np.where(near.mask, near.indices, 0))


def test_bytes_are_those_of_the_tool(surface, run_tool, tmp_path):
    np.save(tmp_path / "in.npy", surface)
    run_tool("neighbors", "in.npy", "out.npy", "-k", 10, "--distances", "d.npy")
    indices, distances = ps.neighbors(surface, k=10)
    assert np.load(tmp_path / "out.npy").tobytes() == indices.tobytes()
    assert np.load(tmp_path / "d.npy").tobytes() == distances.tobytes()


@pytest.mark.filterwarnings("ignore:k = 4 is more")
@pytest.mark.parametrize("n", [1, 2, 5])
def test_few_points_have_few_neighbors(n):
    xyz = np.arange(3.0 * n).reshape(n, 3)
    indices, distances = ps.neighbors(xyz, k=4)
    assert indices.shape == distances.shape == (n, 4)
    assert np.all((~np.isnan(distances)).sum(1) == min(4, max(0, n - 1)))
    offsets, rows, _ = ps.neighbors(xyz, radius=100.0)
    assert list(offsets) == [i * max(0, n - 1) for i in range(n + 1)]


def test_points_that_are_not_finite_have_no_neighbors_and_are_none(surface):
    xyz = surface.copy()
    xyz[[5, 50, 500]] = np.nan
    xyz[7, 2] = np.inf
    bad = [5, 7, 50, 500]
    indices, distances = ps.neighbors(xyz, k=6)
    assert np.isnan(distances[bad]).all() and not np.isin(indices, bad).any()
    offsets, rows, _ = ps.neighbors(xyz, radius=0.3)
    assert all(offsets[b] == offsets[b + 1] for b in bad) and not np.isin(rows, bad).any()


def test_a_radius_holds_the_squared_distances_that_are_at_most_its_rounded_square():
    rng = np.random.default_rng(3)
    for _ in range(20):
        xyz = rng.random((2, 3)) * 100
        dx, dy, dz = xyz[0] - xyz[1]
        squared = (dx * dx + dy * dy) + dz * dz
        radius = np.sqrt(squared)
        while radius * radius < squared:
            radius = np.nextafter(radius, np.inf)
        while np.nextafter(radius, 0) ** 2 >= squared:
            radius = np.nextafter(radius, 0)
        for r, count in ((np.nextafter(radius, 0), 0), (radius, 1), (np.nextafter(radius, np.inf), 1)):
            assert len(ps.neighbors(xyz, radius=r)[1]) == 2 * count
            assert (ps.neighbors(xyz, k=1, radius=r).indices[0, 0] == 1) == bool(count)


def test_threads_and_memory_change_no_byte(surface):
    many = np.concatenate([surface + [20.0 * i, 0, 0] for i in range(100)])
    expected = ps.neighbors(many, radius=0.2, threads=1)
    got = ps.neighbors(many, radius=0.2, threads=2, memory="64M")
    assert all(a.tobytes() == b.tobytes() for a, b in zip(expected, got))


@pytest.mark.parametrize("neighborhood", [{"k": 6}, {"radius": 0.3}])
def test_points_left_out_have_no_rows(surface, neighborhood):
    xyz = surface.copy()
    xyz[[0, 50, 2999]] = np.nan
    left = ps.neighbors(np.delete(xyz, [0, 50, 2999], axis=0), **neighborhood)
    with pytest.warns(ps.PointsweepWarning, match="Dropped 3 points .* report.statistics lists their rows"):
        found = ps.neighbors(xyz, nonfinite="drop", **neighborhood)
    assert len(found) == len(left) and all(np.array_equal(a, b) for a, b in zip(found, left))


def test_neighbors_are_in_memory_once():
    xyz = np.random.default_rng(5).random((400_000, 3))
    ps.neighbors(xyz[:1000])
    with open("/proc/self/clear_refs", "w") as file:
        file.write("5")  # resets the peak of resident memory

    def status(name):
        with open("/proc/self/status") as file:
            return next(int(line.split()[1]) * 1024 for line in file if line.startswith(name))

    held = status("VmRSS")
    indices, distances = ps.neighbors(xyz, k=64, memory="100M")
    assert status("VmHWM") - held < 1.5 * (indices.nbytes + distances.nbytes)


@pytest.mark.parametrize("k, error", [(0, ps.UsageError), (2**32 - 1, ps.Error), (2**62, ps.UsageError), (2**64, ps.UsageError)])
def test_more_neighbors_than_memory_holds_are_refused(surface, k, error):
    with pytest.raises(error, match="fewer" if error is ps.Error else "number of neighbours"):
        ps.neighbors(surface, k=k)


def nearest_rows(xyz: np.ndarray, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows of all finite points by distance, x, y, z and row, and their squared distances from a finite place."""
    d = xyz - place
    with np.errstate(invalid="ignore"):
        d2 = (d[:, 0] * d[:, 0] + d[:, 1] * d[:, 1]) + d[:, 2] * d[:, 2]
    order = np.lexsort((np.arange(len(xyz)), xyz[:, 2], xyz[:, 1], xyz[:, 0], d2))
    order = order[np.isfinite(xyz[order]).all(1)]
    return order, d2[order]


def expect_neighbors_of(xyz: np.ndarray, queries: np.ndarray, k: int, radius: float, **options) -> None:
    """All three forms against a sort of all points for each query."""
    xyz, queries = np.asarray(xyz, np.float64), np.asarray(queries, np.float64)
    near = ps.neighbors(xyz, k, queries=queries, **options)
    both = ps.neighbors(xyz, k, radius=radius, queries=queries, **options)
    offsets, rows, distances = ps.neighbors(xyz, radius=radius, queries=queries, **options)
    missing = np.iinfo(np.uint32).max
    assert near.indices.shape == near.distances.shape == both.indices.shape == (len(queries), k)
    assert near.indices.dtype == rows.dtype == np.uint32 and near.distances.dtype == distances.dtype == np.float64
    assert offsets.dtype == np.int64 and offsets.shape == (len(queries) + 1,) and offsets[0] == 0
    for i, place in enumerate(queries):
        order, d2 = nearest_rows(xyz, place) if np.isfinite(place).all() else (np.empty(0, int), np.empty(0))
        within = d2 <= radius * radius
        for found, wanted, squares in ((near, order, d2), (both, order[within], d2[within])):
            count = min(k, len(wanted))
            assert np.array_equal(found.indices[i, :count], wanted[:count]), i
            assert np.array_equal(found.distances[i, :count], np.sqrt(squares[:count])), i
            assert np.all(found.indices[i, count:] == missing) and np.isnan(found.distances[i, count:]).all()
        assert np.array_equal(rows[offsets[i] : offsets[i + 1]], order[within]), i
        assert np.array_equal(distances[offsets[i] : offsets[i + 1]], np.sqrt(d2[within])), i


def test_neighbors_of_queries_are_those_of_a_sort(surface):
    rng = np.random.default_rng(1)
    inside = surface[:2000:40] + rng.normal(0, 0.1, (50, 3))
    outside = rng.normal(0, 1, (20, 3)) * [1e3, 1, 1e6]
    expect_neighbors_of(surface, np.concatenate([inside, outside, surface[:10]]), 9, 0.35)
    expect_neighbors_of(surface[:40], inside, 1, 1e7)
    expect_neighbors_of(surface, inside[:7], 300, 0.02)


def test_neighbors_of_queries_at_equal_distances_go_by_position_and_row():
    grid = np.stack(np.meshgrid(*[np.arange(6.0)] * 3), -1).reshape(-1, 3)
    xyz = np.concatenate([grid, grid[::-1], grid[::7]])  # copies, in other rows
    queries = np.concatenate([grid[::5], grid[::11] + 0.5, [[2.5, 2.5, 2.5], [-4.0, 2.0, 2.0]]])
    expect_neighbors_of(xyz, queries, 20, 1.0)
    expect_neighbors_of(xyz, queries, 3, np.sqrt(0.75))
    expect_neighbors_of(np.ones((300, 3)), np.ones((5, 3)), 7, 0.0)


@pytest.mark.filterwarnings("ignore:k = 5 is more")
@pytest.mark.parametrize("n", [1, 2, 4])
def test_neighbors_of_queries_among_few_points(n, surface):
    expect_neighbors_of(surface[:n], surface[:3] + 0.01, 5, 2.0)


def test_a_k_beyond_the_points_is_a_warning_for_queries_as_for_points(surface):
    for queries, others in ((None, 4), (surface[:2], 5)):
        with pytest.warns(ps.PointsweepWarning, match=f"k = 7 is more than the {others} "):
            assert ps.neighbors(surface[:5], 7, queries=queries).mask.sum(1).max() == others


def test_queries_and_points_that_are_not_finite_have_no_neighbors(surface):
    xyz, queries = surface.copy(), surface[:30].copy()
    xyz[[5, 7, 50]] = np.nan
    xyz[9, 1] = np.inf
    queries[3, 0], queries[4] = np.nan, -np.inf
    expect_neighbors_of(xyz, queries, 6, 0.4)
    left = np.delete(xyz, [5, 7, 9, 50], axis=0)
    for neighborhood in ({"k": 6}, {"radius": 0.4}):
        with pytest.warns(ps.PointsweepWarning, match="Dropped 4 points"):
            found = ps.neighbors(xyz, nonfinite="drop", queries=queries, **neighborhood)
        wanted = ps.neighbors(left, queries=queries, **neighborhood)
        assert all(np.array_equal(a, b, equal_nan=a.dtype.kind == "f") for a, b in zip(found, wanted))
    with pytest.raises(ps.Error, match="finite"):
        ps.neighbors(xyz, nonfinite="refuse", queries=queries)
    ps.neighbors(left, nonfinite="refuse", queries=queries)


def test_no_queries_and_no_points(surface):
    none = np.empty((0, 3))
    assert ps.neighbors(surface, 4, queries=none).indices.shape == (0, 4)
    assert np.array_equal(ps.neighbors(surface, radius=1, queries=none).offsets, [0])
    for queries in (None, surface):
        with pytest.raises(ps.Error):
            ps.neighbors(none, 4, queries=queries)
    unplaced = np.full((4, 3), np.nan)
    assert np.isnan(ps.neighbors(unplaced, 2, queries=surface[:3]).distances).all()
    assert len(ps.neighbors(unplaced, radius=2, queries=surface[:3]).indices) == 0


def test_the_points_as_queries_have_themselves_first(surface):
    xyz = np.unique(surface[:900], axis=0)
    own, asked = ps.neighbors(xyz, 5), ps.neighbors(xyz, 6, queries=xyz)
    assert np.array_equal(asked.indices[:, 0], np.arange(len(xyz))) and not asked.distances[:, 0].any()
    assert np.array_equal(asked.indices[:, 1:], own.indices) and np.array_equal(asked.distances[:, 1:], own.distances)


def test_threads_memory_axes_and_order_of_queries_change_no_byte(surface):
    many = np.concatenate([surface + [20.0 * i, 0, 0] for i in range(100)])
    rng = np.random.default_rng(2)
    queries = many[rng.permutation(len(many))[:70_000]] + rng.normal(0, 0.05, (70_000, 3))
    for neighborhood in ({"k": 8}, {"radius": 0.2}):
        expected = ps.neighbors(many, queries=queries, threads=1, **neighborhood)
        for options in ({"threads": 3, "memory": "64M"}, {"axis": "y"}, {"axis": "z", "threads": 1, "memory": "48M"}):
            got = ps.neighbors(many, queries=queries, **options, **neighborhood)
            assert all(a.tobytes() == b.tobytes() for a, b in zip(expected, got)), options
    shuffled = rng.permutation(len(queries))
    near = ps.neighbors(many, 8, queries=queries)
    assert np.array_equal(ps.neighbors(many, 8, queries=queries[shuffled]).indices, near.indices[shuffled])


def test_queries_may_have_every_form_of_points_and_points_may_be_files(surface, tmp_path):
    queries = surface[:200] + 0.01
    expected = ps.neighbors(surface, 4, queries=queries)
    x, y, z = queries.T
    forms = [{"xyz": queries}, {"x": x, "y": y, "z": z}, queries.tolist(), np.asfortranarray(queries), queries[::-1][::-1]]
    rows = np.empty(len(queries), [("x", "f8"), ("y", "f8"), ("z", "f8"), ("label", "u1")])
    rows["x"], rows["y"], rows["z"] = x, y, z
    for form in [*forms, rows, ps.run(queries, "where(1 < 2)")]:
        assert np.array_equal(ps.neighbors(surface, 4, queries=form).indices, expected.indices)
    whole = np.arange(30).reshape(10, 3)
    assert np.array_equal(ps.neighbors(surface, 4, queries=whole).indices, ps.neighbors(surface, 4, queries=whole * 1.0).indices)
    names = ["a.ply", "b.ply", "c.las"]
    for part, name in zip((surface[:1700], surface[1700:], np.round(surface, 3)), names):
        ps.write(str(tmp_path / name), part)
    for files in (names[:2], names[2:]):
        paths = [tmp_path / name for name in files]
        read = ps.open(paths).read(keep="xyz")["xyz"]
        for points in (ps.open(paths), paths):
            found = ps.neighbors(points, 4, queries=queries)
            assert found.indices.tobytes() == ps.neighbors(read, 4, queries=queries).indices.tobytes()


@pytest.mark.parametrize(
    "queries, words",
    [
        (np.zeros((3, 2)), r"queries: has the shape \(3, 2\), but needs \(n, 3\)"),
        (np.zeros((3, 7)), "queries: has the shape .*transpose it"),
        (np.zeros(3), "queries: has the shape"),
        ({"x": [1.0], "y": [2.0]}, "queries: have no 'z'"),
        ("a.las", r"queries: are positions in arrays; those of files are open\(files\).read"),
        (iter([np.zeros((3, 3))]), "queries: is an iterator"),
        ([["a", "b", "c"]], "queries: "),
    ],
)
def test_queries_that_are_no_positions_are_refused(surface, queries, words):
    with pytest.raises(ps.UsageError, match=words):
        ps.neighbors(surface, 4, queries=queries)


def test_queries_in_another_coordinate_system_are_refused(surface):
    geopandas = pytest.importorskip("geopandas")
    frame = geopandas.GeoDataFrame(geometry=geopandas.points_from_xy(*surface[:50].T), crs="EPSG:25832")
    expected = ps.neighbors(surface, 3, queries=surface[:50]).indices
    assert np.array_equal(ps.neighbors(surface, 3, queries=frame).indices, expected)
    assert np.array_equal(ps.neighbors(surface, 3, queries=frame, crs="EPSG:25832").indices, expected)
    with pytest.raises(ps.UsageError, match="queries: are in .*25832.*, but the points in .*2154"):
        ps.neighbors(surface, 3, queries=frame, crs="EPSG:2154")
    ignoring = ps.neighbors(surface, 3, queries=frame, crs="EPSG:2154", ignore_crs=True)
    assert np.array_equal(ignoring.indices, expected)
