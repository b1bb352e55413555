# SPDX-License-Identifier: MIT
"""Clouds of the tests, and the command-line tool that results are compared with."""

import json
import keyword
import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from pointsweep import _stages


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


@pytest.fixture(scope="session")
def declarations(tool):
    """The declarations of all operators in the registry."""
    return json.loads(subprocess.run([tool, "operators", "--json"], check=True, capture_output=True, text=True).stdout)


VALUES = {
    "condition": "x > 1", "assignments": "a = x + 1", "attributes": ["a", "b"], "numbers": [0, 0, 1, 1], "matrix": [[0, -1, 0, 5], [1, 0, 0, 6], [0, 0, 1, 7]], "point": (1, 2, 3.5),
    "file": "other.ply",
}  # fmt: skip


def samples(option):
    """Values of an option, by its declaration alone."""
    kind, choices = option["kind"], option.get("choices")
    least, most = option.get("range") or (0, None)
    least = least or 0
    if kind == "names":
        return [choices, choices[:1]]
    if kind == "choice":
        return [choice in ("yes", "true") for choice in choices] if set(choices) <= {"no", "yes", "false", "true"} else choices
    if kind == "whole":
        return [int(least) + 1, int(least) + 2]
    if kind == "number":
        return [least + 0.75, least + 1.5] if most is None else [(least + most) / 2, most]
    return [VALUES.get(kind, "word")]


def made_by(operator):
    """Returns for a declaration the function, values of its required options, and the declarations of all its options."""
    make = getattr(_stages, {"set": "assign"}.get(operator["name"], operator["name"]))
    options = {o["name"] + "_" * keyword.iskeyword(o["name"]): o for o in operator["options"]}
    return make, {name: samples(option)[0] for name, option in options.items() if option["required"]}, options
