# SPDX-License-Identifier: MIT
"""Every block of code in docs/python.md, and the examples."""

import json
import re
import runpy
import subprocess
import sys
import warnings
from pathlib import Path

import numpy as np
import pytest

import pointsweep as ps

ROOT = Path(__file__).resolve().parents[2]


def test_the_blocks_of_the_documentation_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiles").mkdir()
    try:
        for i in range(2):
            ps.generate("volume", 3000, tmp_path / f"tiles/{i}.laz", seed=i + 1)
    except ps.Error as error:
        pytest.skip(str(error))
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "docs/python.md").read_text(), re.DOTALL)
    assert len(blocks) == 8
    names: dict = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert len(names["clean"]["row"]) < 200_000 and set(names["t"]) == {"xyz", "normal"}
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["0.laz", "1.laz"]


def test_the_block_of_the_first_page_runs(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiles").mkdir()
    try:
        ps.generate("volume", 3000, tmp_path / "tiles/0.laz")
    except ps.Error as error:
        pytest.skip(str(error))
    (block,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    exec(compile(block, "README.md", "exec"), {})
    assert "roughness" in ps.open(tmp_path / "out/0.laz").attributes


def test_the_tasks_in_python_run(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    try:
        ps.generate("terrain", 20_000, tmp_path / "scan.laz")
    except ps.Error as error:
        pytest.skip(str(error))
    table = (ROOT / "docs/tasks.md").read_text().split("## In Python")[1]
    codes = re.findall(r"`([^`]+)`", table)
    assert len(codes) >= 4
    for code in codes:
        exec(compile(code, "docs/tasks.md", "exec"), {"ps": ps, "np": np})
    assert "label" in ps.open(tmp_path / "labels.laz").attributes


def test_the_example_on_arrays_runs(capsys):
    runpy.run_path(str(ROOT / "python/examples/arrays.py"))
    assert "no outliers" in capsys.readouterr().out


def test_the_example_of_an_operator_runs(tmp_path):
    ps.generate("volume", 5000, tmp_path / "in.ply")
    command = [sys.executable, ROOT / "python/examples/own_operator.py", tmp_path / "in.ply", tmp_path / "out.ply"]
    subprocess.run(command, check=True, capture_output=True)
    assert "roughness" in ps.open(tmp_path / "out.ply").attributes


def test_the_notebook_runs_and_has_its_pictures():
    pytest.importorskip("matplotlib")
    from notebook import run_notebook

    path = ROOT / "examples/tour.ipynb"
    kept = json.loads(path.read_text())
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # a warning would appear in the notebook
        made = run_notebook(path)
    kinds = [[output["output_type"] for output in cell.get("outputs", [])] for cell in made["cells"]]
    assert kinds == [[output["output_type"] for output in cell.get("outputs", [])] for cell in kept["cells"]]
    assert sum(kind == ["display_data"] for kind in kinds) == 2
    assert "text/html" in made["cells"][2]["outputs"][0]["data"]


def test_the_example_with_numba_runs(tmp_path):
    pytest.importorskip("numba")
    cloud = ps.generate("terrain", 5000, tmp_path / "in.ply")
    command = [sys.executable, ROOT / "python/examples/with_numba.py", tmp_path / "in.ply", tmp_path / "out.ply"]
    subprocess.run(command, check=True, capture_output=True)
    made = ps.run(tmp_path / "out.ply", "decimate(1)", keep=["prominence"])["prominence"]
    xyz = ps.run(cloud, "decimate(1)")["xyz"].astype(float)
    d = xyz[ps.neighbors(xyz, 16).indices] - xyz[:, None]
    within = d[:, :, 2] ** 2 <= d[:, :, 0] ** 2 + d[:, :, 1] ** 2
    assert np.allclose(made, np.where(within, -d[:, :, 2], 0).max(1).clip(0), atol=1e-6)
