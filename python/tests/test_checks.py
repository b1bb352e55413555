# SPDX-License-Identifier: MIT
"""Looking at files and checking results, against the command-line tool."""

import json
import subprocess
import warnings

import numpy as np
import pytest

import pointsweep as ps


@pytest.fixture
def scan(tmp_path):
    """A LAS file with classes, returns and times."""
    random = np.random.default_rng(11)
    xyz = random.random((3000, 3)) * [20, 20, 2] + [431000, 5410000, 300]
    attributes = {
        "xyz": xyz,
        "classification": random.integers(1, 4, 3000).astype(np.uint8),
        "return_number": np.ones(3000, np.uint8),
        "number_of_returns": np.ones(3000, np.uint8),
        "gps_time": np.linspace(100, 200, 3000),
    }
    ps.run(attributes, "decimate(1)", to=tmp_path / "scan.las", crs=25832 if _has_pyproj() else None)
    return tmp_path / "scan.las"


def _has_pyproj():
    try:
        import pyproj  # noqa: F401
    except ImportError:
        return False
    return True


def test_a_summary_is_what_the_tool_writes(scan, tool):
    told = subprocess.run([tool, "info", "--json", scan], check=True, capture_output=True, text=True).stdout
    its = json.loads(told)["files"][0]
    mine = ps.info(scan)
    for name in ("path", "format", "bytes", "points", "nonfinite", "density", "density_cell", "spacing", "spacing_sample"):
        assert getattr(mine, name) == its[name], name
    assert [list(corner) for corner in mine.bounds] == [its["bounds"]["min"], its["bounds"]["max"]]
    assert mine.classes == {int(code): points for code, points in its["classes"].items()}
    assert sum(mine.classes.values()) == 3000 and mine.returns == {1: 3000}
    assert mine.gps_time.min == 100 and mine.gps_time.max == 200
    assert list(mine.attributes) == [a["name"] for a in its["attributes"]]
    assert mine.attributes["classification"].type == np.uint8 and mine.attributes["classification"].max == 3
    assert [list(p.stages) for p in mine.provenance] == [p["stages"] for p in its["provenance"]]
    assert (mine.crs is None) == (its["crs"] is None)
    assert "3,000" in repr(mine) and "3,000" in mine._repr_html_()


def test_a_summary_without_spacing_has_none(scan):
    assert ps.info(scan).spacing > 0
    assert ps.info(scan, spacing=False).spacing is None


def test_a_header_that_does_not_fit_is_a_warning(scan):
    data = bytearray(scan.read_bytes())
    data[179:187] = np.float64(1e6).tobytes()  # the greatest x of the header
    scan.write_bytes(data)
    with pytest.warns(ps.PointsweepWarning, match="the header states x"):
        summary = ps.info(scan)
    assert any("the header states x" in sentence for sentence in summary.warnings)


def test_what_is_no_point_file_is_refused(tmp_path):
    (tmp_path / "a.ply").write_text("nothing")
    with pytest.raises(ps.Error, match="a.ply"):
        ps.info(tmp_path / "a.ply")
    with pytest.raises(ps.UsageError, match="is a folder"):
        ps.info(tmp_path)
    with pytest.raises(ps.UsageError, match="not a path"):
        ps.info(7)


def test_a_right_output_is_verified_by_its_record(scan, tool):
    out = scan.with_name("out.las")
    ps.run(scan, "knn(k=8) | normals | density", to=out)
    verdict = ps.verify(out, sample=500)
    assert verdict and verdict.same and verdict.complete
    assert verdict.samples == 500 and verdict.wrong_samples == 0
    assert set(verdict.computed) == {"normal", "surface_density", "volume_density"}
    told = subprocess.run([tool, "verify", out, "--sample", "500"], check=True, capture_output=True, text=True).stdout
    assert str(verdict) == told
    assert verdict.conclusion == told.splitlines()[-1]


def test_a_wrong_value_is_found(surface, tmp_path):
    t = ps.run(surface, "knn(k=8) | normals", keep=["normal"])
    normals = t["normal"].copy()
    normals[17] = np.roll(normals[17], 1)
    for name, values in (("in.ply", {"xyz": surface}), ("out.ply", {"xyz": surface, "normal": normals})):
        ps.run(values, "decimate(1)", to=tmp_path / name)
    verdict = ps.verify(tmp_path / "out.ply", tmp_path / "in.ply", pipeline=ps.knn(8) | ps.normals(), sample=0, rows=[17, 18])
    assert not verdict and not verdict.same and verdict.wrong_samples == 1
    assert verdict.differences[0].startswith("row 17: ")
    assert ps.verify(tmp_path / "out.ply", tmp_path / "in.ply", pipeline="knn(k=8) | normals", sample=0, rows=18)


def test_neighbours_are_those_of_the_run(surface, tmp_path):
    ps.run({"xyz": surface}, "decimate(1)", to=tmp_path / "in.ply")
    np.save(tmp_path / "rows.npy", ps.neighbors(surface, k=5).indices)
    assert ps.verify(tmp_path / "rows.npy", tmp_path / "in.ply", k=5)
    with pytest.raises(ps.UsageError, match="5 columns"):
        ps.verify(tmp_path / "rows.npy", tmp_path / "in.ply", k=6)


def test_an_output_without_a_record_needs_its_inputs(surface, tmp_path):
    ps.run({"xyz": surface}, "decimate(1)", to=tmp_path / "in.ply")
    np.save(tmp_path / "rows.npy", ps.neighbors(surface, k=5).indices)
    with pytest.raises(ps.UsageError, match="does not say how it was made"):
        ps.verify(tmp_path / "rows.npy")


def test_an_operator_of_python_cannot_be_verified(tmp_path):
    @ps.operator(makes={"up": "f4"}, neighbors=False)
    def up(p):
        return p.xyz[:, 2]

    with pytest.raises(ps.UsageError, match="operator of Python"):
        ps.verify(tmp_path / "a.ply", pipeline=ps.knn(8) | up)


def test_a_callback_ends_a_check(scan):
    def stop(phase, done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ps.info(scan, progress=stop)
    with pytest.raises(KeyboardInterrupt):
        ps.verify(scan, scan, progress=stop)


def test_verify_compares_whole_numbers_of_64_bits_exactly(tmp_path):
    random = np.random.default_rng(5)
    points = {
        "xyz": random.random((500, 3)).round(3),
        "large": random.integers(0, 50, 500).astype("u8") + np.uint64(2**64 - 60),
        "least": random.integers(-20, 20, 500) + (-(2**63) + 30),
    }
    ps.write(tmp_path / "in.las", points)
    names = "large_max, large_majority, large_range, least_min, least_majority, least_mean"
    pipeline = f"knn(k=3) | statistics({names}) | set(copy = large, as=uint64)"
    ps.run(tmp_path / "in.las", pipeline, to=tmp_path / "out.las")
    verdict = ps.verify(tmp_path / "out.las", tmp_path / "in.las")
    assert verdict, str(verdict)
    found = ps.read(tmp_path / "out.las", keep=["copy", "large_max"])
    assert np.array_equal(found["copy"], points["large"]) and (found["large_max"] >= 2**64 - 60).all()


def test_verify_takes_the_options_of_a_run_without_a_record(scan, tmp_path):
    rounded = {"decimals": 2, "positions": "float32"}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ps.PointsweepWarning)  # warnings of the lost coordinate system and of rounding
        ps.run(scan, "knn(8) | normals", to=tmp_path / "out.csv", **rounded)
    assert not ps.verify(tmp_path / "out.csv", scan, k=8)
    assert ps.verify(tmp_path / "out.csv", scan, k=8, **rounded)
    (tmp_path / "cells").mkdir()
    for divided in ({"tile": 5.0, "tile_origin": (1, 2), "tile_buffer": 1.0}, {"split": "classification"}):
        ps.run(scan, "knn(8) | normals", to=tmp_path / "cells", provenance=False, **divided)
        verdict = ps.verify(tmp_path / "cells", scan, k=8, **divided)
        assert verdict and verdict.complete, str(verdict)
        for tile in (tmp_path / "cells").iterdir():
            tile.unlink()
