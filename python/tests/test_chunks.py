# SPDX-License-Identifier: MIT
"""Results block by block, values of the whole cloud, and operators without neighbours."""

import gc
import os

import numpy as np
import pytest

import pointsweep as ps

CHAIN = "knn(k=8) | normals"


def joined(parts):
    parts = list(parts)
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


@pytest.fixture
def file(surface, tmp_path):
    path = tmp_path / "in.las"
    ps.run({"xyz": surface, "intensity": np.arange(3000, dtype=np.uint16)}, "decimate(1)", to=path)
    return path


def test_blocks_are_the_rows_of_the_run(surface):
    t = ps.run(surface, CHAIN, keep=["xyz", "normal"])
    parts = list(ps.chunks(surface, 1024, CHAIN, keep=["xyz", "normal"]))
    assert [len(part["row"]) for part in parts] == [1024, 1024, 952]
    together = joined(parts)
    assert together["xyz"].tobytes() == t["xyz"].tobytes() and together["normal"].tobytes() == t["normal"].tobytes()
    assert np.array_equal(together["row"], np.arange(3000))


@pytest.mark.parametrize("keep", [None, ["intensity", "normal"]])
def test_blocks_of_files_have_the_numbers_of_the_rows_that_are_left(file, keep):
    chain = CHAIN + " | where(intensity >= 500 && intensity < 2000) | decimate(0.5)"
    expected = ps.open(file).run(chain, keep=keep)
    together = joined(ps.open(file).chunks(100, chain, keep=keep))
    assert np.array_equal(together.pop("row"), expected["intensity"])
    assert set(together) == set(expected)
    for name in expected:
        assert together[name].tobytes() == expected[name].tobytes(), name


def test_blocks_of_arrays_have_the_numbers_of_the_rows_that_are_left(surface):
    chain = CHAIN + " | decimate(0.5)"
    expected = ps.run(surface, chain)
    together = joined(ps.chunks(surface, 77, chain))
    assert set(together) == set(expected) and np.array_equal(together["row"], expected["row"])
    kept = joined(ps.chunks(surface, 77, chain, keep="normal"))
    assert list(kept) == ["normal", "row"] and np.array_equal(kept["row"], expected["row"])


@pytest.mark.filterwarnings("ignore:Dropped 3 points")
@pytest.mark.parametrize("nonfinite", ["keep", "drop"])
@pytest.mark.parametrize("order", ["input", "sweep"])
def test_a_point_without_a_finite_place_has_its_number(tmp_path, surface, nonfinite, order):
    missing = [5, 17, 2500]
    xyz = surface.copy()
    xyz[missing] = np.nan
    ps.run({"xyz": xyz, "id": np.arange(3000)}, "decimate(1)", to=tmp_path / "a.ply")
    for chain in [CHAIN, CHAIN + " | where(id >= 3)", CHAIN + " | reneighbor(k=4) | decimate(0.5)", "where(id >= 3)", "voxel(1)"]:
        for points in (tmp_path / "a.ply", {"xyz": xyz, "id": np.arange(3000)}):
            together = joined(ps.chunks(points, 500, chain, keep="id", nonfinite=nonfinite, order=order))
            assert np.array_equal(together["row"], together["id"]), chain
            left = set(together["row"].tolist()) & set(missing)
            assert not left if nonfinite == "drop" else left or "decimate" in chain, chain


def test_without_a_pipeline_blocks_are_the_points_themselves(file, surface):
    cloud = ps.open(file)
    together = joined(cloud.chunks(1000))
    assert np.array_equal(together["intensity"], np.arange(3000)) and together["xyz"].shape == (3000, 3)
    assert np.array_equal(joined(cloud.chunks(999, keep="xyz"))["xyz"], together["xyz"])
    assert np.array_equal(joined(ps.chunks(surface, 1000))["xyz"], surface)


def test_memory_threads_and_blocks_change_no_byte(file):
    a = joined(ps.chunks(file, 3000, CHAIN, threads=1))
    b = joined(ps.chunks(file, 7, CHAIN, threads=4, memory="40M"))
    assert a["normal"].tobytes() == b["normal"].tobytes()


def test_closing_or_forgetting_the_iterator_removes_its_file(surface, tmp_path):
    def held():
        gc.collect()
        return len(os.listdir("/proc/self/fd"))

    before = held()
    with ps.chunks(surface, 100, CHAIN, temp_folder=tmp_path) as parts:
        assert next(parts)["normal"].shape == (100, 3) and parts.report.points == 3000
        assert held() == before + 1 and os.listdir(tmp_path) == []
    assert held() == before and list(parts) == []
    parts = ps.chunks(surface, 100, CHAIN)
    next(parts)
    del parts
    assert held() == before
    assert len(list(ps.chunks(surface, 100, CHAIN))) == 30 and held() == before


def test_wrong_requests_are_refused(surface, tmp_path):
    with pytest.raises(ps.UsageError, match="rows: 0"):
        ps.chunks(surface, 0, CHAIN)
    with pytest.raises(ps.UsageError, match="resume"):
        ps.chunks(surface, 10, CHAIN, resume="folder")
    with pytest.raises(ps.UsageError, match="curvature"):
        ps.chunks(surface, 10, CHAIN, keep="curvature")
    with pytest.raises(ps.Error, match="nowhere"):
        ps.chunks(surface, 10, CHAIN, temp_folder=tmp_path / "nowhere")


def test_a_value_of_the_whole_cloud(surface, file):
    @ps.reduce(start=[], keep=["xyz"])
    def heights(seen, block):
        """Highest z of each block."""
        seen.append(block["xyz"][:, 2].max())
        return seen

    assert max(heights(surface)) == surface[:, 2].max() and len(heights(surface, rows=1000)) == 3
    assert heights.start == [] and "Highest" in heights.__doc__

    @ps.reduce(start=0.0)
    def tilted(n, block):
        return n + (np.abs(block["normal"][:, 2]) < 0.7).sum()

    assert tilted(file, CHAIN, rows=17) == tilted(file, CHAIN, memory="40M", threads=1)


def test_a_mask_selects_points(surface, file):
    @ps.select(reads=["normal"])
    def flat(p):
        return np.abs(p.normal[:, 2]) > 0.9

    normal = ps.normals(surface, 8)
    rows = np.flatnonzero(np.abs(normal[:, 2]) > 0.9)
    t = ps.run(surface, CHAIN | flat)
    assert np.array_equal(t["row"], rows) and t["normal"].tobytes() == normal[rows].tobytes()
    later = ps.run(surface, [CHAIN, flat, "sor"], keep=["mean_distance"])
    expected = ps.run(surface[rows], "knn(k=8) | sor", keep=["mean_distance"])
    assert later["mean_distance"].tobytes() == expected["mean_distance"].tobytes()
    assert ps.run(file, CHAIN | flat, order="sweep", memory="40M")["xyz"].shape[1] == 3

    @ps.select(reads=["intensity"])
    def odd(p):
        return p.intensity % 2 == 1

    assert np.array_equal(ps.run(file, odd)["intensity"], np.arange(1, 3000, 2))

    @ps.select()
    def wrong(p):
        return np.ones(len(p))

    with pytest.raises(ps.UsageError, match="needs a mask"):
        ps.run(surface, wrong)

    @ps.select()
    def curious(p):
        return p.neighbors.counts > 0

    with pytest.raises(ps.UsageError, match="sees no neighbours"):
        ps.run(surface, curious)


def test_a_mask_is_asked_of_points_that_are_not_finite(surface):
    xyz = surface.copy()
    xyz[5] = np.nan

    @ps.select()
    def finite(p):
        return np.isfinite(p.xyz).all(1)

    assert 5 not in ps.run(xyz, finite)["row"]


def test_an_operator_without_neighbors_needs_no_search(surface):
    @ps.operator(makes={"height": "f8"}, neighbors=False)
    def height(p):
        return p.xyz[:, 2] - 300

    t = ps.run(surface, height)
    assert np.array_equal(t["height"], surface[:, 2] - 300)
    with pytest.raises(ps.UsageError, match="neighbors=True"):
        ps.operator(makes={"a": "f4"}, reads_neighbors=["b"], neighbors=False)(lambda p: p)


def test_check_finds_what_is_no_pure_function(surface):
    @ps.operator(reads=["normal"], makes={"roughness": "f4"})
    def roughness(p):
        d = p.neighbors_xyz - p.xyz[:, None]
        return np.abs(np.einsum("nkj,nj->nk", d, p.normal)).mean(1)

    found = ps.check(roughness)
    assert found and "all with the same bytes" in repr(found) and len(found.runs) == 6
    assert ps.check(roughness, surface)

    @ps.operator(makes={"above": "f4"})
    def above(p):
        return p.xyz[:, 2] - p.xyz[:, 2].mean()  # wrong on purpose: the mean of the batch

    found = ps.check(above)
    assert not found and "batches of one point: above differs" in repr(found)

    @ps.select()
    def every_other(p):
        return np.arange(len(p)) % 2 == 0

    assert not ps.check(every_other) and not ps.check(every_other, surface)

    @ps.select()
    def high(p):
        return p.xyz[:, 2] > 300

    assert ps.check(high, surface)
    with pytest.raises(ps.UsageError, match="give an operator"):
        ps.check(lambda p: p)


@pytest.mark.filterwarnings("ignore:Dropped 3 points")
def test_rows_are_counted_before_points_are_dropped_also_without_a_pipeline(surface, tmp_path):
    xyz = surface.copy()
    missing = [1, 700, 2999]
    xyz[missing] = np.nan
    ps.write(tmp_path / "a.ply", xyz)
    left = np.delete(np.arange(3000), missing)
    for points in (xyz, tmp_path / "a.ply"):
        for keep in (None, "xyz", ["row"], ["row", "xyz"]):
            together = joined(ps.chunks(points, 500, nonfinite="drop", keep=keep))
            assert np.array_equal(together["row"], left), keep
        assert np.array_equal(joined(ps.chunks(points, 500, keep=["row"]))["row"], np.arange(3000))


def test_an_attribute_row_of_a_file_is_kept_and_leaves_its_name_only_if_not_wanted(tmp_path):
    rows = [f"{i},{i % 3},{i % 2},{100 - i}" for i in range(10)]
    (tmp_path / "a.csv").write_text("\n".join(["x,y,z,row", *rows]))
    cloud = ps.open(tmp_path / "a.csv")
    own, numbers = 100 - np.arange(10), np.arange(10)
    for keep in (None, ["row"], ["row", "xyz"]):
        assert np.array_equal(joined(cloud.chunks(3, keep=keep))["row"], own)
        assert np.array_equal(joined(cloud.chunks(3, "where(x >= 4)", keep=keep))["row"], own[4:])
    assert np.array_equal(joined(cloud.chunks(3, keep="xyz"))["row"], numbers)
    assert np.array_equal(joined(cloud.chunks(3, "where(x >= 4)", keep="xyz"))["row"], numbers[4:])
    assert np.array_equal(joined(cloud.chunks(3, "knn(k=3) | normals"))["row"], numbers)


def test_blocks_of_files_with_columns(file):
    label = np.arange(3000) * 7
    cloud = ps.open(file).with_columns(label=label)
    together = joined(ps.chunks(cloud, 700))
    assert np.array_equal(together["label"], label) and np.array_equal(together["intensity"], np.arange(3000))
    together = joined(ps.chunks(cloud, 700, "where(label >= 70)", keep="label"))
    assert np.array_equal(together["row"], np.arange(10, 3000)) and np.array_equal(together["label"], label[10:])
    with pytest.raises(ps.UsageError, match="would give their rows of the columns to others"):
        ps.chunks(cloud, 700, nonfinite="drop")


def test_a_reduction_has_the_name_of_its_function(surface):
    @ps.reduce(start=0)
    def number(n, block):
        return n + len(block["row"])

    assert number.__name__ == "number" and number(surface) == 3000
    with pytest.raises(ps.UsageError, match="with parentheses"):
        ps.reduce(lambda n, block: n)
    with pytest.raises(ps.UsageError, match="5 is no function"):
        ps.reduce(start=0)(5)
