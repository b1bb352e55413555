# SPDX-License-Identifier: MIT
"""Operators in Python against NumPy on arrays in memory."""

import filecmp
import subprocess
import threading
import traceback

import numpy as np
import pytest

import pointsweep as ps


@ps.operator(reads=["normal"], makes={"roughness": "f4"})
def roughness(p):
    d = p.neighbors_xyz - p.xyz[:, None]
    return np.abs(np.einsum("nkj,nj->nk", d, p.normal)).mean(1)


@ps.operator(reads=["intensity", "normal"], reads_neighbors=["intensity", "normal"], makes={"contrast": "f8", "lean": ("f4", 3)})
def contrast(p):
    return {
        "contrast": (p.neighbors["intensity"] - p.intensity[:, None]).max(1),
        "lean": p.neighbors["normal"].sum(1) - p.normal,
    }


def roughness_in_memory(xyz, k):
    rows = ps.neighbors(xyz, k).indices
    d = xyz[rows] - xyz[:, None]
    return np.abs(np.einsum("nkj,nj->nk", d, ps.normals(xyz, k))).mean(1).astype(np.float32)


def test_an_operator_gets_exact_neighborhoods(surface):
    arrays = ps.run(surface, ["knn(k=16) | normals", roughness])
    assert list(arrays) == ["normal", "roughness"] and arrays["roughness"].dtype == np.float32
    assert np.array_equal(arrays["roughness"], roughness_in_memory(surface, 16))


def test_attributes_of_neighbors_and_several_results(surface):
    intensity = np.arange(3000, dtype=np.uint16) % 251
    arrays = ps.run(surface, "knn(k=8) | normals" | contrast, attributes={"intensity": intensity})
    rows = ps.neighbors(surface, 8).indices
    values = intensity.astype(float)
    assert np.array_equal(arrays["contrast"], (values[rows] - values[:, None]).max(1))
    np.testing.assert_array_equal(arrays["lean"], ps.normals(surface, 8)[rows].sum(1) - ps.normals(surface, 8))


def test_later_stages_read_what_it_makes(surface):
    kept = ps.run(surface, "knn(k=16) | normals" | roughness | "where(roughness < 0.01) | features")
    expected = roughness_in_memory(surface, 16) < 0.01
    assert 0 < expected.sum() < 3000
    assert np.array_equal(kept["row"], np.flatnonzero(expected)) and "planarity" in kept


def test_radius_neighborhoods_have_masks(surface):
    @ps.operator(makes={"spread": "f8", "near": "i4"})
    def spread(p):
        assert p.neighbors.mask.shape == p.neighbors.rows.shape == p.neighbors_xyz.shape[:2]
        assert np.array_equal(np.isnan(p.neighbors_xyz).any(2), ~p.neighbors.mask)
        assert np.array_equal(p.neighbors.rows < len(surface), p.neighbors.mask)
        if not p.neighbors.mask.all():
            with pytest.raises(IndexError):
                surface[p.neighbors.rows]
        d = np.linalg.norm(p.neighbors_xyz - p.xyz[:, None], axis=2)
        return np.where(p.neighbors.mask, d, 0).sum(1), p.neighbors.counts

    arrays = ps.run(surface, ["knn(radius=0.3)", spread])
    offsets, _, distances = ps.neighbors(surface, radius=0.3)
    sums = np.array([distances[a:b].sum() for a, b in zip(offsets, offsets[1:])])
    assert np.array_equal(arrays["near"], np.diff(offsets))
    np.testing.assert_allclose(arrays["spread"], sums, rtol=1e-12)


def test_neighborhoods_of_a_radius_without_empty_places(surface):
    @ps.operator(reads_neighbors=["intensity"], makes={"brightest": "f8", "sum": "f8"})
    def brightest(p):
        offsets, rows = p.neighbors.offsets, p.neighbors.flat("rows")
        assert offsets.dtype == np.int64 and offsets.shape == (len(p) + 1,)
        assert p.neighbors.flat("xyz").shape == (len(rows), 3) == (offsets[-1], 3)
        assert np.array_equal(p.neighbors.flat("xyz"), surface[rows])
        values = p.neighbors.flat("intensity")
        assert np.array_equal(values, rows % 251)
        parts = [values[a:b] for a, b in zip(offsets, offsets[1:])]
        return np.array([part.max(initial=-1) for part in parts]), np.array([part.sum() for part in parts])

    arrays = ps.run(surface, ["knn(radius=0.1)", brightest], attributes={"intensity": np.arange(3000) % 251})
    offsets, rows, _ = ps.neighbors(surface, radius=0.1)
    lists = [rows[a:b] % 251 for a, b in zip(offsets, offsets[1:])]
    assert min(map(len, lists)) == 0 < max(map(len, lists))
    assert arrays["brightest"].tolist() == [max(part, default=-1) for part in lists]
    assert arrays["sum"].tolist() == [part.sum() for part in lists]


def test_a_list_of_neighbors_has_no_other_attributes(surface):
    @ps.operator(makes={"leaning": "f4"})
    def reads_too_much(p):
        return p.neighbors.flat("normal")

    with pytest.raises(ps.UsageError, match="name it in reads_neighbors"):
        ps.run(surface, ["knn(k=4) | normals", reads_too_much])


def test_it_moves_points(surface):
    @ps.operator(makes={"position": ("f8", 3)})
    def smooth(p):
        return np.nanmean(np.concatenate([p.neighbors_xyz, p.xyz[:, None]], 1), 1)

    arrays = ps.run(surface, ["knn(k=6)", smooth, "reneighbor | normals"])
    rows = ps.neighbors(surface, 6).indices
    expected = np.concatenate([surface[rows], surface[:, None]], 1).mean(1)
    np.testing.assert_allclose(arrays["xyz"], expected, rtol=1e-14)
    assert arrays["normal"].tobytes() == ps.normals(arrays["xyz"], 6).tobytes()


def test_what_it_moves_far_away_is_in_las_where_it_was_put(surface, tmp_path):
    @ps.operator(makes={"position": ("f8", 3)}, neighbors=False)
    def to_the_map(p):
        return p.xyz + [512000, 5403000, 0]

    small = tmp_path / "local.laz"
    ps.run(np.round(surface, 4), "decimate(1)", to=small)
    ps.run(small, to_the_map, to=tmp_path / "map.laz")
    expected = ps.run(small, to_the_map)["xyz"]
    np.testing.assert_allclose(ps.run(tmp_path / "map.laz", "decimate(1)")["xyz"], expected, rtol=0, atol=0.5001e-4)


def test_threads_memory_and_order_change_no_byte():
    xyz = ps.generate("terrain", 400_000)["xyz"]
    chain = "knn(k=8) | normals" | roughness
    expected = ps.run(xyz, chain, threads=1)["roughness"]
    spilled = ps.run(xyz, chain, threads=2, memory="40M")
    assert spilled.report.statistics["bytes"]["spilled"] > 0
    assert spilled["roughness"].tobytes() == expected.tobytes()
    sweep = ps.run(xyz, chain, threads=2, order="sweep")
    assert sweep["roughness"].tobytes() == expected[sweep["row"]].tobytes()


def test_points_that_are_not_finite_are_not_passed(surface):
    xyz = surface.copy()
    xyz[4] = np.nan

    @ps.operator(makes={"seen": "u1", "real": "f4"})
    def seen(p):
        assert np.isfinite(p.xyz).all() and np.isfinite(p.neighbors_xyz).all() and 4 not in p.rows
        return np.ones(len(p)), np.ones(len(p), np.float32)

    with pytest.raises(ps.UsageError, match="float64 for 'seen'"):
        ps.run(xyz, [seen])

    seen.function = lambda p: {"seen": np.ones(len(p), np.uint8), "real": p.xyz[:, 0]}
    arrays = ps.run(xyz, [seen])
    assert np.flatnonzero(arrays["seen"] == 0).tolist() == np.flatnonzero(np.isnan(arrays["real"])).tolist() == [4]


def test_points_that_are_not_finite_are_passed_to_operators_of_the_points_alone_and_keep_what_others_remake(surface):
    xyz = surface.copy()
    xyz[4] = np.nan
    gain = np.arange(float(len(xyz)))

    @ps.operator(reads=["gain"], makes={"gain": "f8"})
    def smooth(p):
        return p["gain"] + p.neighbors.counts

    @ps.operator(reads=["gain"], makes={"twice": "f8"}, neighbors=False)
    def twice(p):
        return 2 * p["gain"]

    for before in ("knn(k=8)", "knn(k=8) | normals"):
        arrays = ps.run({"xyz": xyz, "gain": gain}, before | smooth | twice)
        expected = gain + 8
        expected[4] = gain[4]
        assert np.array_equal(arrays["gain"], expected) and np.array_equal(arrays["twice"], 2 * expected)


def test_an_exception_ends_the_run_with_its_traceback(surface, tmp_path):
    @ps.operator(makes={"broken": "f4"})
    def broken(p):
        return 1 / np.float64(len(p) * [0]).tolist()[0] if len(p) else 0

    with pytest.raises(ZeroDivisionError) as caught:
        ps.run(surface, [broken], to=tmp_path / "out.ply")
    assert "in broken" in "".join(traceback.format_tb(caught.value.__traceback__))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("result", "sentence"),
    [
        (lambda p: None, "returned nothing"),
        (lambda p: np.zeros(3), r"shape \(3,\)"),
        (lambda p: np.zeros((len(p), 1)), "needs"),
        (lambda p: np.zeros(len(p), complex), "complex128"),
        (lambda p: {"other": 1}, "without 'value'"),
        (lambda p: p["normal"], "name it in reads"),
        (lambda p: p.neighbors["normal"], "reads_neighbors"),
    ],
)
def test_wrong_results_are_refused_with_a_sentence(surface, result, sentence):
    op = ps.operator(makes={"value": "f4"}, name="wrong")(result)
    with pytest.raises(ps.UsageError, match=sentence):
        ps.run(surface, [op])


def test_what_it_reads_has_to_be_there(surface):
    with pytest.raises(ps.UsageError, match="roughness: needs 'normal'"):
        ps.run(surface, ["knn(k=8)", roughness])
    with pytest.raises(ps.UsageError, match="is not a type"):
        ps.operator(makes={"a": "no type"})(len)
    with pytest.raises(ps.UsageError, match="makes nothing"):
        ps.operator(makes={})(len)


def test_a_batch_is_of_no_use_after_the_call(surface):
    kept = []

    @ps.operator(makes={"one": "f4"})
    def keeps(p):
        kept.append((p, p.xyz, p.rows))
        return np.ones(len(p), np.float32)

    ps.run(surface, [keeps])
    p, xyz, rows = kept[0]
    assert np.isin(xyz[:, 0], surface[:, 0]).all()  # arrays may be kept
    assert p.xyz is xyz and p.rows is rows
    with pytest.raises(ps.UsageError, match="during its call only"):
        p.neighbors_xyz


def test_a_run_inside_of_an_operator(surface):
    @ps.operator(makes={"inner": "f4"})
    def inner(p):
        return ps.normals(p.xyz, 3)[:, 0]

    assert ps.run(surface, [inner])["inner"].shape == (3000,)


def test_interrupting_while_it_runs(surface):
    main = threading.main_thread()
    assert threading.current_thread() is main

    def stop(phase, done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ps.run(np.tile(surface, (40, 1)), ["knn(k=8) | normals", roughness], progress=stop)


def test_it_works_on_files_and_its_source_is_part_of_a_resumed_run(tmp_path):
    ps.generate("volume", 20000, tmp_path / "in.ply")
    chain = "knn(k=8) | normals" | roughness
    ps.open(tmp_path / "in.ply").run(chain, to=tmp_path / "a.ply", threads=2)
    ps.open(tmp_path / "in.ply").run(chain, to=tmp_path / "b.ply", resume=tmp_path / "progress")
    assert filecmp.cmp(tmp_path / "a.ply", tmp_path / "b.ply", shallow=False)
    assert "roughness" in ps.open(tmp_path / "a.ply").attributes


def test_a_run_is_not_resumed_with_another_function(tmp_path):
    cloud = ps.generate("volume", 20000, tmp_path / "in.ply")

    def times(factor):
        @ps.operator(makes={"scaled": "f8"})
        def scaled(p):
            return factor * p.xyz[:, 0]

        return scaled

    def stop(phase, done, total):
        if phase != "ordering":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        cloud.run([times(2)], to=tmp_path / "out.ply", resume=tmp_path / "progress", progress=stop)
    with pytest.raises(ps.Error, match="progress"):
        cloud.run([times(3)], to=tmp_path / "out.ply", resume=tmp_path / "progress")
    with pytest.warns(ps.PointsweepWarning, match="Went on"):
        cloud.run([times(2)], to=tmp_path / "out.ply", resume=tmp_path / "progress")
    out = ps.run(tmp_path / "out.ply", "decimate(1)")
    assert np.array_equal(out["scaled"], 2 * out["xyz"][:, 0].astype(float))


def test_the_tool_verifies_the_stages_around_it(tmp_path, tool):
    ps.generate("volume", 5000, tmp_path / "in.ply").run("knn(k=16) | normals" | roughness, to=tmp_path / "out.ply")
    command = [tool, "verify", "in.ply", "out.ply", "-k", "16"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 3 and done.stdout.endswith("not checked: 1 attribute; all else is correct\n"), done


def test_reprs(surface):
    assert repr(roughness) == "<pointsweep.Operator roughness: normal -> roughness float32>"
    assert repr("knn(k=8) | normals" | roughness) == "<pointsweep.Pipeline: knn(k=8) | normals | roughness>"


def test_masked_results_are_refused(surface):
    @ps.operator(makes={"a": "f8"}, neighbors=False)
    def masked(p):
        return np.ma.masked_less(np.arange(len(p)), 1)

    @ps.select()
    def some(p):
        return np.ma.masked_array(np.ones(len(p), bool), mask=True)

    for stage in (masked, some):
        with pytest.raises(ps.UsageError, match="returned masked values"):
            ps.run(surface, stage)


def test_a_batch_that_is_over_raises_one_error(surface):
    kept = []

    @ps.operator(reads=["normal"], makes={"a": "f8"})
    def keep(p):
        kept.append(p)
        return p.xyz[:, 0]

    ps.run(surface, ps.knn(8) | ps.normals() | keep)
    assert kept[0].xyz.shape[1] == 3
    with pytest.raises(ps.UsageError):
        kept[0].normal
    with pytest.raises(AttributeError, match="does not read 'curvature'"):
        kept[0].curvature


def test_xyz_is_not_the_name_of_an_attribute(surface):
    with pytest.raises(ps.UsageError, match="make 'position'"):
        ps.operator(makes={"xyz": ("f8", 3)})(lambda p: p.xyz)


@pytest.mark.parametrize(
    ("kind", "value", "words"),
    [
        ("i1", np.int64(300), "q would be 300, which is not int8, -128 to 127"),
        ("i4", np.int64(3_000_000_000), "q would be 3000000000, which is not int32"),
        ("u1", np.uint64(256), "q would be 256, which is not uint8, 0 to 255"),
        ("u8", np.int8(-1), "q would be -1, which is not uint64"),
        ("i8", np.uint64(2**63), "q would be 9223372036854775808, which is not int64"),
        ("f4", np.float64(1e300), r"q would be 1e\+300, which is not float32"),
        ("f4", np.float64(-1e39), r"q would be -1e\+39, which is not float32"),
    ],
)
def test_a_value_that_the_promised_type_does_not_hold_is_refused_with_its_row(kind, value, words):
    xyz = np.random.default_rng(1).random((3000, 3))

    def some(p):
        return np.where(p.rows == 233, value, value.dtype.type(1))

    with pytest.raises(ps.UsageError, match=f"operator 'some': row 233: {words}"):
        ps.run(xyz, ps.operator(makes={"q": kind}, neighbors=False)(some))

    def pairs(p):
        return np.stack([np.ones(len(p), value.dtype), some(p)], 1)

    with pytest.raises(ps.UsageError, match=f"operator 'pairs': row 233: {words}"):
        ps.run(xyz, ps.operator(makes={"q": (kind, 2)})(pairs))


@pytest.mark.parametrize(
    ("kind", "value"),
    [
        ("u1", np.int64(255)), ("i1", np.uint64(127)), ("u8", np.int64(2**62)), ("i8", np.uint64(2**63 - 1)), ("u2", np.True_), ("f8", np.int64(3)),
        ("f4", np.float64(0.1)), ("f4", np.float64(np.inf)), ("f4", np.float64(np.nan)), ("f4", np.True_), ("f4", np.float16(0.5)),
    ],
)  # fmt: skip
def test_a_value_that_the_promised_type_holds_is_taken_from_any_type(kind, value):
    made = ps.run(np.random.default_rng(1).random((50, 3)), ps.operator(makes={"q": kind}, neighbors=False)(lambda p: np.full(len(p), value)))["q"]
    assert made.dtype == kind and np.array_equal(made, np.full(50, value).astype(kind), equal_nan=True)


def test_real_numbers_are_not_taken_for_integers(surface):
    op = ps.operator(makes={"q": "i4"})(lambda p: np.ones(len(p)))
    with pytest.raises(ps.UsageError, match=r"returned float64 for 'q', which makes int32; convert it, e.g. with .astype\('int32'\)"):
        ps.run(surface, op)


def test_decorators_are_told_from_functions_and_take_names_from_any_iterable(surface):
    op = ps.operator(reads=(name for name in ["normal"]), makes={"up": "f4"})(lambda p: p.normal[:, 2])
    assert op.reads == ["normal"] and ps.run(surface, "knn(k=8) | normals" | op)["up"].shape == (3000,)
    assert ps.select(reads=iter(["normal"]))(len).reads == ["normal"]
    assert op.__name__ == "<lambda>" and roughness.__name__ == "roughness"
    for call, words in [
        (lambda: ps.operator(len), r"operator: .* write @pointsweep.operator\(makes=.*with parentheses"),
        (lambda: ps.select(len), r"write @pointsweep.select\(reads=.*with parentheses"),
        (lambda: ps.operator(makes={"a": "f4"})(5), "5 is no function"),
        (lambda: ps.select()("normals"), "'normals' is no function"),
    ]:
        with pytest.raises(ps.UsageError, match=words):
            call()


def test_set_makes_no_attribute_that_hides_the_positions(surface, tmp_path):
    for stage in ("set(xyz = 0)", "set(x = 1, xyz = 2 where z > 0)", ps.assign("xyz = 3")):
        for call in (lambda s: ps.run(surface, s), lambda s: ps.chunks(surface, 10, s), lambda s: ps.run(surface, [s, "where(x > 0)"])):
            with pytest.raises(ps.UsageError, match="'xyz' is what results call the positions"):
                call(stage)
    assert list(ps.run(surface, "set(xyzw = 1)")) == ["xyzw"]
