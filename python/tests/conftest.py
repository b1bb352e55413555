# SPDX-License-Identifier: MIT
"""Clouds of the tests, and the command-line tool that results are compared with."""

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest


@pytest.fixture(scope="session")
def surface() -> np.ndarray:
    """3,000 points of a wavy surface, float64, far from the origin as maps are, with some exact duplicates."""
    random = np.random.default_rng(7)
    xy = random.uniform(0, 10, (3000, 2))
    z = np.sin(xy[:, 0]) * np.cos(xy[:, 1]) + random.normal(0, 0.01, 3000)
    xyz = np.column_stack([xy, z]) + [431000.0, 5410000.0, 300.0]
    xyz[100:110] = xyz[200:210]
    return xyz


@pytest.fixture(scope="session")
def tool() -> str:
    """The command-line tool of the same build."""
    path = os.environ.get("POINTSWEEP_TOOL") or shutil.which("pointsweep")
    if path is None:
        pytest.skip("the tool pointsweep is not there; set POINTSWEEP_TOOL")
    return path


@pytest.fixture
def run_tool(tool, tmp_path):
    """Runs the tool; its files are in tmp_path."""

    def run(*arguments) -> Path:
        subprocess.run([tool, *map(str, arguments), "--quiet"], check=True, cwd=tmp_path)
        return tmp_path

    return run
