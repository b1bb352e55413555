# SPDX-License-Identifier: MIT
"""Every block of code in docs/python.md, and the examples."""

import re
import runpy
import subprocess
import sys
from pathlib import Path

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
    assert len(blocks) == 3
    names: dict = {}
    for block in blocks:
        exec(compile(block, "docs/python.md", "exec"), names)
    assert len(names["clean"]["row"]) < 200_000 and set(names["t"]) == {"xyz", "normal"}
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["0.laz", "1.laz"]


def test_the_example_on_arrays_runs(capsys):
    runpy.run_path(str(ROOT / "python/examples/arrays.py"))
    assert "no outliers" in capsys.readouterr().out


def test_the_example_of_an_operator_runs(tmp_path):
    ps.generate("volume", 5000, tmp_path / "in.ply")
    command = [sys.executable, ROOT / "python/examples/own_operator.py", tmp_path / "in.ply", tmp_path / "out.ply"]
    subprocess.run(command, check=True, capture_output=True)
    assert "roughness" in ps.open(tmp_path / "out.ply").attributes
