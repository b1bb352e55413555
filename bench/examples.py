# SPDX-License-Identifier: MIT
"""The examples of all operators, taken from `pointsweep operators --json`, and clouds whose spacing suits their lengths."""
import json
import re
import subprocess

SPACING = 0.3  # the radii, cells and distances of the examples then hold some points each


def examples(tool, other):
    """The pipeline of each operator, by name. The file `other` takes the place of other clouds."""
    told = subprocess.run([tool, "operators", "--json"], check=True, capture_output=True, text=True).stdout
    return {operator["name"]: re.sub(r"\b\w+\.las\b", f'"{other}"', operator["example"]) for operator in json.loads(told)}


def scaled(tool, files, output, attributes=()):
    """Makes one file of the points of all files, unless it exists: scaled to a given spacing, around the origin, with whole numbers
    from 0 to 127 as `attributes`."""
    if not output.exists():
        told = json.loads(subprocess.run([tool, "info", "--json", *files], check=True, capture_output=True, text=True).stdout)
        factor = SPACING / max(file["spacing"] for file in told["files"])
        moved = ", ".join(f"{axis} = {axis} * {factor!r}" for axis in "xyz")
        numbers = "".join(f", {name} = abs(floor(x)) - 128 * floor(abs(floor(x)) / 128)" for name in attributes)
        subprocess.run([tool, "run", *files, output, "--quiet", "--force", "--pipeline", f"set({moved}{numbers})", "--keep", ",".join(["x,y,z", *attributes])], check=True)
    return output
