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
        file.write("5")  # the peak begins here

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
