# SPDX-License-Identifier: MIT
"""Attributes of another cloud, against SciPy."""

import numpy as np
import pytest
from scipy.spatial import cKDTree

import pointsweep as ps


@pytest.fixture(scope="module")
def clouds(tmp_path_factory):
    random = np.random.default_rng(3)
    points, places = random.random((100_000, 3)) * [100, 100, 5], random.random((10_000, 3)) * [100, 100, 5]
    other = {
        "xyz": places,
        "label": random.integers(0, 6, len(places)).astype("u1"),
        "height": random.random(len(places)).astype("f4"),
    }
    path = tmp_path_factory.mktemp("take") / "other.ply"
    ps.write(path, other)
    return points, other, path


def test_nearest_values_are_those_of_scipy(clouds):
    points, other, path = clouds
    _, rows = cKDTree(other["xyz"]).query(points)
    taken = ps.run(points, ps.take(path, ["label", "height"]))
    assert taken["label"].dtype == np.uint8 and np.array_equal(taken["label"], other["label"][rows])
    assert taken["height"].dtype == np.float32 and np.array_equal(taken["height"], other["height"][rows])


def test_votes_of_several_are_those_of_scipy(clouds):
    points, other, path = clouds
    distances, rows = cKDTree(other["xyz"]).query(points, k=5)
    labels = other["label"][rows]
    counts = (labels[:, :, None] == labels[:, None, :]).sum(axis=2)
    majority = labels[np.arange(len(labels)), counts.argmax(axis=1)]  # the first of the most frequent is the nearest
    taken = ps.run(points, ps.take(ps.open(path), "label", k=5))
    assert np.array_equal(taken["label"], majority)
    means = ps.run(points, ps.take(path, ["label", "height"], k=5, vote="mean"))
    assert np.array_equal(means["label"], labels.sum(axis=1, dtype=float) / 5)
    assert np.allclose(means["height"], other["height"][rows].mean(axis=1, dtype=float), rtol=1e-14)
    near = ps.run(points, ps.take(path, ["label"], most=1, missing=255))
    assert np.array_equal(near["label"], np.where(distances[:, 0] <= 1, labels[:, 0], 255))


def test_what_does_not_fit_is_refused(clouds):
    points, _, path = clouds
    with pytest.raises(ps.UsageError, match="has no attribute 'lable'; the nearest it has are 'label'"):
        ps.run(points, ps.take(path, ["lable"]))
    with pytest.raises(ps.UsageError, match="give missing=NUMBER"):
        ps.run(points, ps.take(path, ["label"], most=1))
    with pytest.raises(ps.UsageError, match="is not a path"):
        ps.take(points, ["label"])
    with pytest.raises(ps.Error, match="row 0: 'height' would be .* not int16"):
        ps.run({"xyz": points, "height": np.zeros(len(points), "i2")}, ps.take(path, ["height"]))
