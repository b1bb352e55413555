# SPDX-License-Identifier: MIT
"""Pictures of arrays and files are those that the tool draws."""

import os
import subprocess

import numpy as np
import pytest

import pointsweep as ps

TOOL = os.environ.get("POINTSWEEP_TOOL", "pointsweep")


def test_a_picture_has_the_bytes_of_the_tool(tmp_path):
    ps.generate("terrain", 5000, tmp_path / "a.las")
    options = ["--color", "z", "--view", "30,40", "--up", "z", "--size", "300x200", "--background", "20242c", "--no-legend", "--point-size", "3"]
    subprocess.run([TOOL, "render", tmp_path / "a.las", tmp_path / "tool.png", *options, "--quiet"], check=True)
    picture = ps.render(ps.open(tmp_path / "a.las"), color="z", view="30,40", up="z", size=(300, 200), background="20242c", legend=False, point_size=3)
    assert picture.png == (tmp_path / "tool.png").read_bytes() == picture._repr_png_()
    assert picture.color == "z" and picture.range[0] < picture.range[1] and picture.outside == 0
    subprocess.run([TOOL, "render", tmp_path / "a.las", tmp_path / "plain.png", "--quiet"], check=True)
    assert ps.render(tmp_path / "a.las").png == (tmp_path / "plain.png").read_bytes()


def test_a_picture_of_arrays_shows_their_attributes(tmp_path):
    xyz = np.random.default_rng(1).random((2000, 3))
    picture = ps.render(xyz, attributes={"label": np.arange(2000) % 3}, color="label", size=(64, 48))
    assert picture.color == "label" and picture.png.startswith(b"\x89PNG")
    picture.save(tmp_path / "a.png")
    with pytest.raises(FileExistsError):
        picture.save(tmp_path / "a.png")
    picture.save(tmp_path / "a.png", overwrite=True)
    assert (tmp_path / "a.png").read_bytes() == picture.png
    with pytest.raises(ps.UsageError, match="pictures are PNG"):
        picture.save(tmp_path / "a.jpg")


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"size": 300}, "^size: 300 is not a pair of width and height"),
        ({"size": (8, 8)}, "^size: 8x8 is no size of a picture; each side is 16"),
        ({"view": "sideways"}, "^view: 'sideways' is not auto, front, top"),
        ({"up": "w"}, "^up: 'w' is not auto, x, y, z"),
        ({"background": "green"}, "^background: 'green' is not white, black or RRGGBB"),
        ({"color": "labels"}, "^color: .*'labels'"),
        ({"point_size": 0}, "^point_size: 0 is no diameter in pixels; give a number above 0"),
        ({"point_size": -1}, "^point_size: -1 is no diameter"),
    ],
)
def test_what_is_wrong_is_said(options, words):
    with pytest.raises(ps.UsageError, match=words):
        ps.render(np.random.default_rng(1).random((50, 3)), **options)


def test_points_without_a_place_are_an_error():
    with pytest.raises(ps.Error):
        ps.render(np.full((5, 3), np.nan))
